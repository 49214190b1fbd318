// Uniform media made of random fibres, with probes in them and the transmittance that is expected there.
#pragma once

#include <functional>
#include <vector>

#include "tests/support/strand_models.h"

namespace hairbake::test_support {

/// The medium whose transmittance is expected.
/// - mean_field: thin fibres as extinction.
/// - fibres: true fibres with round ends. A ray from a point meets the fibres whose centres lie in a known volume;
///   their number has a Poisson distribution. For isotropic fibres of length L the optical depth per length is sigma (1
///   + w / L), because the mean projected area of a convex body is a quarter of its surface, pi w (L + w) / 4. A point
///   is inside a fibre with the optical depth sigma w (volume over projection); there A = 0.
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
/// scatter. `evaluate` bakes or traces: it gives A of the medium's probes.
struct MeanError {
    double mean = 0, standard_error = 0;
};
MeanError mean_error(int realisations, const std::function<Medium(Random&)>& make,
                     const std::function<std::vector<float>(const Medium&)>& evaluate);

}  // namespace hairbake::test_support
