// The window of the near-field correction and what the grid's voxels weigh in it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace hairbake {

/// q(d) = (1 - d^2 / r^2)^2 for d < r. weight[o] = integral over voxel o around the vertex's voxel of q(d) / d^2,
/// averaged over the vertex's place in its voxel, and for the own voxel times pi / 4, the mean sine; o = 9 (i + 1) +
/// 3 (j + 1) + (k + 1) for the offset (i, j, k); padded with zeros.
struct NearFieldWindow {
    static constexpr float radius =
        0.5f;  ///< r in voxels: half a voxel, so that the neighbouring half-voxel cells suffice
    static constexpr std::size_t offsets = 27, padded = 32;

    /// -ln A of a lone straight thin strand on the grid after the correction, over opacity * width / h: averaged over
    /// directions and places of the strand. tests/core/volume derives it.
    static constexpr float own_strand_beyond = 0.352f;

    /// How much of the correction a vertex of average transmittance A gets: none below `dark`, all above `light`. Most
    /// vertices of a dense groom lie in the dark and are many to a voxel; without the correction they err by no more
    /// than a fraction of their small A, and with this the work grows with the hair that is seen, not with its square.
    static constexpr float dark = 0.03f, light = 0.06f;
    static float share(float average) { return std::clamp((average - dark) / (light - dark), 0.0f, 1.0f); }

    /// A vertex with more pieces than this in the cells around it is left to the mean field, which is right for that
    /// many; so the work stays linear however many strands a voxel holds.
    static constexpr std::size_t most_pieces = 4096;
    /// The correction gives back at most the factor e: a voxel beside a dense bundle cannot make A what it likes.
    static constexpr float most_gain = 1;

    alignas(64) std::array<float, padded> weight{};
    alignas(64) std::array<float, padded> direction_x{}, direction_y{}, direction_z{};  ///< unit, 0 for the own voxel
    alignas(64) std::array<std::int32_t, padded> step{};  ///< of Neighborhood's voxel index

    NearFieldWindow();
};

}  // namespace hairbake
