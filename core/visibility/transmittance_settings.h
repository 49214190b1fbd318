// The request's `transmittance` block: how the light that reaches a vertex is computed, and which results are kept.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/base/names.h"

namespace hairbake {

enum class DirectionSet {
    fibonacci,   ///< spherical Fibonacci lattice (any count): the default; error about N^-3/4, no seed
    stratified,  ///< n x n jittered cells of equal solid angle in (cos theta, phi) (square counts), seeded
    random       ///< independent and uniform: the published method's 100 random directions, seeded
};

enum class TransmittanceMethod {
    volume,        ///< mean field: density grid, sheared sweep, near-field correction
    opacity_maps,  ///< layered deep opacity maps, the published estimator, for comparison
    trace,         ///< Embree traces every vertex against the true strands: slow, the reference
    automatic      ///< `auto`: trace for small models, else volume (core/stages/transmittance_method.h)
};

inline constexpr std::array transmittance_method_names{
    EnumName{TransmittanceMethod::automatic, "auto"}, EnumName{TransmittanceMethod::volume, "volume"},
    EnumName{TransmittanceMethod::opacity_maps, "opacity_maps"}, EnumName{TransmittanceMethod::trace, "trace"}};

/// Settings of the method opacity_maps.
struct OpacityMapSettings {
    int layers = 3;            ///< 1 to 16
    double layer_spacing = 2;  ///< each layer is this many times as thick as the one before, 1 to 16
    int resolution = 512;      ///< texels on the longer edge of a map, 16 to 4096
};

/// The request's `transmittance` block.
struct TransmittanceSettings {
    TransmittanceMethod method = TransmittanceMethod::automatic;
    int directions = 100;  ///< 1 to 4096; a traced bake takes more (traced_directions())
    DirectionSet direction_set = DirectionSet::fibonacci;
    std::uint64_t seed = 1;            ///< of the stratified and random sets
    std::optional<int> voxels;         ///< on the longest axis of the bounds, 32 to 1024; empty: auto (grid_frame.h)
    std::optional<double> voxel_size;  ///< model units, instead of `voxels`; > 0
    int sh_bands = 0;                  ///< bands of directional transmittance, 1 to 4; 0 for none
    bool bent_cone = false;            ///< also bake bent cones
    OpacityMapSettings opacity_maps;
    int reference_vertices = 256;  ///< traced for the error bar, 0 to 100000
};

}  // namespace hairbake
