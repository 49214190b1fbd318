// Uniform media made of random fibres, with probes in them and what the probes must see.
#pragma once

#include <functional>
#include <vector>

#include "tests/support/strand_models.h"

namespace hairbake::test_support {

/// Whose transmittance is expected: that of the mean field, thin fibres as extinction, or that of true fibres with
/// round ends. For these a ray from a point meets as many as have their centre in a known volume (Poisson): optical
/// depth sigma (1 + w / L) per length for isotropic fibres of length L (mean projected area of a convex body: a quarter
/// of its surface, pi w (L + w) / 4), and a point is inside a fibre with the optical depth sigma w (volume over
/// projection), where A = 0.
enum class Truth { mean_field, fibres };

struct Medium {
    StrandModel model;
    std::uint32_t first_probe = 0;
    std::vector<double> expected;  ///< A of each probe
};

/// Ball of radius 1, probes at distance r of its centre.
Medium ball_medium(Random& random, const Fibres& fibres, double r, int probes, Truth truth);
/// The same filled with parallel fibres; expected by summing over 4,096 directions.
Medium parallel_ball_medium(Random& random, const Fibres& fibres, double r, int probes, Truth truth);
/// Slab of height h, `width` wide on both sides, filled from z = 0 to h; probes at height z in the middle.
Medium slab_medium(Random& random, const Fibres& fibres, double h, double width, double z, int probes, Truth truth);

/// Mean over realisations (seeds 1, 2, ...) of the probes' mean of A - expected, and its standard error from their
/// scatter. What is baked or traced: `evaluate` gives A of the medium's probes.
struct MeanError {
    double mean = 0, standard_error = 0;
};
MeanError mean_error(int realisations, const std::function<Medium(Random&)>& make,
                     const std::function<std::vector<float>(const Medium&)>& evaluate);

}  // namespace hairbake::test_support
