// The transmittance stage: how much of the sky each hair vertex sees through the other hair (spec, section 3).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/direction_set.h"
#include "core/base/progress.h"
#include "core/hair/strand_geometry.h"

namespace hairbake {

class DensityGrid;

enum class TransmittanceMethod {
    volume,  ///< mean field: density grid, sheared sweep, near-field correction
    trace    ///< Embree, every vertex against the true strands: slow, the truth
};

/// The request's `transmittance` block.
struct TransmittanceSettings {
    TransmittanceMethod method = TransmittanceMethod::volume;
    int directions = 100;  ///< 1 to 4096
    DirectionSet direction_set = DirectionSet::fibonacci;
    std::uint64_t seed = 1;            ///< of the stratified and random sets
    int voxels = 256;                  ///< on the longest axis of the bounds, 32 to 1024
    std::optional<double> voxel_size;  ///< model units, instead of `voxels`; > 0
    int reference_vertices = 256;      ///< traced for the error bar, 0 to 100000
};

/// A(x) at every vertex and how it came about. Times and memory are measured by the caller.
struct Transmittance {
    std::vector<float> average;  ///< [V], A in [0, 1], file order
    int directions = 0;
    double voxel_size = 0;                       ///< effective h in model units; 0 for `trace`
    std::uint64_t occupied_voxels = 0;           ///< voxels with extinction; 0 for `trace`
    std::shared_ptr<const DensityGrid> density;  ///< what the sweep walked; null for `trace` and for an empty model
    std::vector<std::string> warnings;           ///< e.g. that the widths bounded the voxel size from below
};

/// Mean-field transmittance of every vertex:
///   A(x) = (1/N) sum over k of exp(-Omega(x, w_k)),  Omega = opacity * integral of extinction,
/// (Xing 2012, eq. 3 and 4, with the 1/N that the paper's text leaves out), times the near-field correction.
/// Deterministic bit for bit for any thread count; values agree to 1e-5 between SIMD targets.
/// Throws Error(usage) for settings out of range, Error(bad_input) for bounds that no grid can hold,
/// Error(out_of_resources), Error(cancelled). `settings.method` and `reference_vertices` are not looked at.
Transmittance bake_transmittance_volume(const StrandGeometry& strands, const TransmittanceSettings& settings,
                                        Progress& progress);

}  // namespace hairbake
