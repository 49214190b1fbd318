#include "core/stages/transmittance_method.h"

namespace hairbake {

ChosenMethod choose_method(TransmittanceMethod asked, std::size_t vertices, std::size_t receiver_positions) {
    if (asked != TransmittanceMethod::automatic) return {asked, "as the request asks"};
    const std::size_t points = vertices + receiver_positions;
    const std::string allowed = std::to_string(most_traced_points);
    std::string what = std::to_string(vertices) + " vertices";
    if (receiver_positions > 0) what += " and " + std::to_string(receiver_positions) + " positions of the receiver";
    if (points <= most_traced_points)
        return {TransmittanceMethod::trace, "auto: " + what + "; up to " + allowed + " are traced"};
    return {TransmittanceMethod::volume, "auto: " + what + "; more than " + allowed + " are swept"};
}

int traced_directions(int directions) {
    constexpr int most = 4096;
    for (const int times : {9, 4})
        if (times * directions <= most) return times * directions;
    return directions;
}

}  // namespace hairbake
