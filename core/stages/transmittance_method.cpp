#include "core/stages/transmittance_method.h"

#include <algorithm>

namespace hairbake {

std::size_t most_traced_points(int directions) {
    const double n = directions;
    return static_cast<std::size_t>(std::clamp(0.02 * n * n * n, 5'000.0, 250'000.0));
}

ChosenMethod choose_method(const TransmittanceSettings& settings, std::size_t vertices,
                           std::size_t receiver_positions) {
    if (settings.method != TransmittanceMethod::automatic) return {settings.method, "as the request asks"};
    const std::size_t points = vertices + receiver_positions, most = most_traced_points(settings.directions);
    const std::string allowed =
        std::to_string(most) + " are traced with " + std::to_string(settings.directions) + " directions";
    std::string what = std::to_string(vertices) + " vertices";
    if (receiver_positions > 0) what += " and " + std::to_string(receiver_positions) + " positions of the receiver";
    return {points <= most ? TransmittanceMethod::trace : TransmittanceMethod::volume,
            "auto: " + what + "; up to " + allowed};
}

int traced_directions(int directions) {
    constexpr int most = 4096;
    for (const int times : {9, 4})
        if (times * directions <= most) return times * directions;
    return directions;
}

}  // namespace hairbake
