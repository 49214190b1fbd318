#include "core/output/tone.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace hairbake {
namespace {

/// Narkowicz's fit of the ACES film curve (2015): 0 to 0, 1 to 0.80, never above 1.
double film(double x) { return std::clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0); }

/// The linear values between neighbouring 8-bit codes: code k stands for values from boundary k - 1 to k.
std::array<float, 255> make_boundaries() {
    std::array<float, 255> boundaries;
    for (int k = 0; k < 255; ++k) {
        const double encoded = (k + 0.5) / 255;
        const double linear = encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
        boundaries[k] = static_cast<float>(linear);
    }
    return boundaries;
}

std::uint8_t to_srgb(double linear) {
    static const std::array<float, 255> boundaries = make_boundaries();
    return static_cast<std::uint8_t>(
        std::upper_bound(boundaries.begin(), boundaries.end(), static_cast<float>(linear)) - boundaries.begin());
}

}  // namespace

double exposure_for(std::vector<float> luminances) {
    if (luminances.empty()) return 0;
    const auto tenth = luminances.end() - 1 - static_cast<std::ptrdiff_t>(luminances.size() / 10);
    std::nth_element(luminances.begin(), tenth, luminances.end());
    return *tenth > 0 ? std::log2(0.35 / *tenth) : 0;
}

Color tone(const Vec3f& rgb, double stops) {
    const double scale = std::exp2(stops);
    const auto channel = [scale](double value) { return to_srgb(film(std::max(0.0, value * scale))); };
    return {channel(rgb.x), channel(rgb.y), channel(rgb.z)};
}

}  // namespace hairbake
