// The window of the near-field correction and the weights of the grid's voxels in it (docs/math.md, "The near field").
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace hairbake {

/// q(d) = (1 - d^2 / r^2)^2 for d < r. Offset (i, j, k) from the vertex's voxel has the index o = 9 (i + 1) + 3 (j + 1)
/// + (k + 1). weight[o] is the integral of q(d) / d^2 over voxel o, averaged over the vertex's place in its voxel. The
/// weight of the vertex's own voxel is multiplied by pi / 4, the mean sine. Arrays are padded with zeros.
struct NearFieldWindow {
    /// r in voxels. With half a voxel only the adjacent cells of half a voxel matter.
    static constexpr float radius = 0.5f;
    static constexpr std::size_t offsets = 27, padded = 32;

    /// Share of the correction for a vertex of average transmittance A: none below `dark`, all above `light`. In a
    /// dense groom most vertices are dark and share a voxel with many others. Their error is at most a fraction of
    /// their small A. Leaving them out makes the work grow with the visible hair, not with the square of all hair.
    static constexpr float dark = 0.03f, light = 0.06f;
    static float share(float average) { return std::clamp((average - dark) / (light - dark), 0.0f, 1.0f); }

    /// A vertex with more pieces than this in the cells around it is not corrected: the mean field is right for so
    /// many. So the work stays linear for any number of strands in a voxel.
    static constexpr std::size_t most_pieces = 4096;
    /// The correction increases A by at most the factor e^most_gain, also in a voxel beside a dense bundle.
    static constexpr float most_gain = 1;

    alignas(64) std::array<float, padded> weight{};
    alignas(64) std::array<float, padded> direction_x{}, direction_y{}, direction_z{};  ///< unit, 0 for the own voxel
    alignas(64) std::array<std::int32_t, padded> step{};  ///< of Neighborhood's voxel index

    NearFieldWindow();
};

}  // namespace hairbake
