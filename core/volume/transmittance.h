// The transmittance stage by the volume method: how much light reaches each hair vertex through the other hair.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/progress.h"
#include "core/hair/strand_geometry.h"
#include "core/mesh/triangle_mesh.h"
#include "core/visibility/transmittance_settings.h"
#include "core/volume/grid_frame.h"

namespace hairbake {

class DensityGrid;
struct HairVolume;

/// The input of the transmittance stage. Refers to its parts, which must outlive it.
struct TransmittanceScene {
    const StrandGeometry& strands;
    const TriangleMesh* occluder = nullptr;  ///< stops light completely
    const TriangleMesh* receiver = nullptr;  ///< the shadow of hair and occluder is baked at its positions as well
    bool receiver_is_occluder = false;       ///< then it does not shadow itself
    bool keep_density = false;               ///< make Transmittance::density, for density.vdb
};

/// An array of a functional.
struct NamedArray {
    std::string_view name;  ///< of a row of the table of arrays (core/result/vertex_array.cpp)
    std::vector<float> values;
};

/// A(x) at every vertex, with facts about its computation. The caller measures time and memory.
struct Transmittance {
    std::vector<float> average;  ///< [V], A in [0, 1], file order
    /// [V * bands^2], c_i = (4 pi / N) sum over k of T_k Y_i(w_k) in the order l*l + l + m; with sh_bands > 0.
    std::vector<float> sh;
    /// [V * 4], unit axis and half-angle in radians; (0, 0, 0, pi) where nothing is blocked; with bent_cone.
    std::vector<float> bent_cone;
    /// [R * 2] for R positions of the receiver: mean of T over the hemisphere about the normal, plain and
    /// cosine-weighted; with a receiver.
    std::vector<float> receiver;
    std::vector<NamedArray> others;  ///< of further functionals
    int directions = 0;
    double voxel_size = 0;                          ///< effective h in model units; 0 for other methods than `volume`
    VoxelReason voxel_reason = VoxelReason::asked;  ///< of the method `volume`
    std::uint64_t occupied_voxels = 0;              ///< voxels with extinction; 0 for other methods than `volume`
    std::shared_ptr<const DensityGrid> density;  ///< the extinction of the sweep; null unless keep_density and `volume`
    std::vector<std::string> warnings;           ///< e.g. that the strands are too wide for the voxels asked for
};

/// Sets the facts about the voxels, and the density where the scene keeps it.
void describe_voxels(const HairVolume& volume, bool keep_density, Transmittance& transmittance);

/// Mean-field transmittance of every vertex:
///   A(x) = (1/N) sum over k of exp(-Omega(x, w_k)),  Omega = opacity * integral of extinction,
/// times the near-field correction. (Xing 2012, eq. 3 and 4, with the 1/N that the paper's text leaves out.)
///
/// scene:    hair, occluder and receiver
/// settings: `method` and `reference_vertices` are not read
///
/// Deterministic bit for bit for any thread count; values agree to 1e-5 between SIMD targets.
/// Throws Error(usage) for settings out of range.
/// Throws Error(bad_input) for bounds that no grid can hold.
/// Throws Error(out_of_resources), Error(cancelled).
Transmittance bake_transmittance_volume(const TransmittanceScene& scene, const TransmittanceSettings& settings,
                                        Progress& progress);

}  // namespace hairbake
