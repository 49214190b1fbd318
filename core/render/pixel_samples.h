// Where the samples of a pixel lie.
#pragma once

#include <cstdint>

#include "core/base/random.h"

namespace hairbake {

/// A point of a pixel, both in [0, 1): x to the right, y down.
struct PixelPoint {
    double x = 0, y = 0;
};

/// A number that depends on all three and looks random: the seed of what happens at one sample of one pixel.
inline std::uint64_t sample_seed(std::uint64_t seed, std::uint64_t pixel, std::uint64_t sample) {
    Random first(seed ^ 0x6A09E667F3BCC908u);
    Random second(first.next_u64() + pixel);
    return Random(second.next_u64() + sample).next_u64();
}

/// The points of one pixel, stratified for any count: point k of n lies in column k of n columns, and the rows follow
/// the golden ratio (Fibonacci lattice), the whole shifted by a random vector of the pixel (Cranley and Patterson
/// 1976) and jittered within the column. The same arguments give the same points everywhere.
class PixelSamples {
public:
    PixelSamples(std::uint64_t seed, std::uint64_t pixel, int count);
    PixelPoint point(int k) const;

private:
    std::uint64_t seed_, pixel_;
    int count_;
    double shift_;
};

}  // namespace hairbake
