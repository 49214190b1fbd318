// Positions of the samples of a pixel.
#pragma once

#include <cstdint>

#include "core/base/random.h"

namespace hairbake {

/// A point of a pixel, both in [0, 1): x to the right, y down.
struct PixelPoint {
    double x = 0, y = 0;
};

/// A pseudo-random number of all three arguments: the seed of one sample of one pixel.
inline std::uint64_t sample_seed(std::uint64_t seed, std::uint64_t pixel, std::uint64_t sample) {
    Random first(seed ^ 0x6A09E667F3BCC908u);
    Random second(first.next_u64() + pixel);
    return Random(second.next_u64() + sample).next_u64();
}

/// The points of one pixel, stratified for any count. Point k of n lies in column k of n columns, jittered within the
/// column; the rows follow the golden ratio (Fibonacci lattice), shifted by a random number of the pixel (Cranley and
/// Patterson 1976). The same arguments give the same points on every machine.
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
