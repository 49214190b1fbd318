// The transmittance stage: how much of the sky each hair vertex sees through the other hair (spec, section 3).
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/hair/strand_geometry.h"
#include "core/mesh/triangle_mesh.h"
#include "core/visibility/transmittance_settings.h"

namespace hairbake {

class DensityGrid;

/// What the transmittance stage reads. Refers to its parts, which must outlive it.
struct TransmittanceScene {
    const StrandGeometry& strands;
    const TriangleMesh* occluder = nullptr;  ///< stops light completely
    const TriangleMesh* receiver = nullptr;  ///< the hair's and the occluder's shadow is asked for at its positions
    bool receiver_is_occluder = false;       ///< then it does not shadow itself
};

/// A(x) at every vertex and how it came about. Times and memory are measured by the caller.
struct Transmittance {
    std::vector<float> average;  ///< [V], A in [0, 1], file order
    /// [V * bands^2], c_i = (4 pi / N) sum over k of T_k Y_i(w_k) in the order l*l + l + m; with sh_bands > 0.
    std::vector<float> sh;
    /// [V * 4], unit axis and half-angle in radians; (0, 0, 0, pi) where nothing is blocked; with bent_cone.
    std::vector<float> bent_cone;
    /// [R * 2] for R positions of the receiver: mean of T over the hemisphere about the normal, plain and
    /// cosine-weighted; with a receiver.
    std::vector<float> receiver;
    int directions = 0;
    double voxel_size = 0;                       ///< effective h in model units; 0 but for `volume`
    std::uint64_t occupied_voxels = 0;           ///< voxels with extinction; 0 but for `volume`
    std::shared_ptr<const DensityGrid> density;  ///< what the sweep walked; null but for `volume` of a model
    std::vector<std::string> warnings;           ///< e.g. that the widths bounded the voxel size from below
};

/// Mean-field transmittance of every vertex:
///   A(x) = (1/N) sum over k of exp(-Omega(x, w_k)),  Omega = opacity * integral of extinction,
/// (Xing 2012, eq. 3 and 4, with the 1/N that the paper's text leaves out), times the near-field correction.
/// Deterministic bit for bit for any thread count; values agree to 1e-5 between SIMD targets.
/// Throws Error(usage) for settings out of range, Error(bad_input) for bounds that no grid can hold,
/// Error(out_of_resources), Error(cancelled). `settings.method` and `reference_vertices` are not looked at.
Transmittance bake_transmittance_volume(const TransmittanceScene& scene, const TransmittanceSettings& settings,
                                        Progress& progress);

}  // namespace hairbake
