#include "core/render/pixel_samples.h"

#include <cmath>

namespace hairbake {

PixelSamples::PixelSamples(std::uint64_t seed, std::uint64_t pixel, int count)
    : seed_(seed), pixel_(pixel), count_(count), shift_(Random(sample_seed(seed, pixel, ~0ull)).next()) {}

PixelPoint PixelSamples::point(int k) const {
    constexpr double golden = 0.6180339887498949;
    const double jitter = Random(sample_seed(seed_, pixel_, static_cast<std::uint64_t>(k))).next();
    const double y = shift_ + golden * k;
    return {(k + jitter) / count_, y - std::floor(y)};
}

}  // namespace hairbake
