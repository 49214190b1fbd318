// A brick with what lies within a voxel of it, laid out for the near-field correction.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/vec.h"
#include "core/hair/strand_geometry.h"
#include "core/volume/extinction_bricks.h"
#include "core/volume/grid_frame.h"
#include "core/volume/near_field_window.h"
#include "core/volume/strand_pieces.h"

namespace hairbake {

/// Local space: voxels, origin at `corner`, so that the brick's own voxels are 1 to 8 on each axis and the halo is 0 and 9. Reused from brick
/// to brick; one per thread.
struct Neighborhood {
    static constexpr int side = 10;
    static constexpr int cells = side * side * side;

    Vec3f corner;  ///< grid space
    // Pieces by cell, z fastest: cell c holds [begin[c], begin[c + 1]). Arrays are padded for vector loads.
    std::array<std::uint32_t, cells + 1> begin{};
    std::vector<float> centre_x, centre_y, centre_z;  ///< local space
    std::vector<float> axis_x, axis_y, axis_z;        ///< unit
    std::vector<float> half_length, weight, radius2;  ///< voxels; opacity * width / h; (width / 2 h)^2
    std::vector<std::int32_t> segment;

    static int cell(int i, int j, int k) { return (i * side + j) * side + k; }

    /// For own voxel (i, j, k): NearFieldWindow::padded values, the weight of each neighbour times its optical depth in the
    /// direction between the two voxels (the voxel itself: mean over directions).
    const float* voxel_depth(int i, int j, int k) const {
        return depth_.data() + static_cast<std::size_t>(cell(i, j, k)) * NearFieldWindow::padded;
    }

    void collect(const StrandGeometry& strands, const GridFrame& frame, const SortedStrands& sorted,
                 const ExtinctionBricks& bricks, const NearFieldWindow& window, std::size_t brick);

private:
    void collect_pieces(const StrandGeometry& strands, const GridFrame& frame, const SortedStrands& sorted);
    void append(const StrandGeometry& strands, const GridFrame& frame, const StrandPiece& piece);
    void collect_depths(const ExtinctionBricks& bricks, const NearFieldWindow& window);

    std::array<std::int32_t, 27> neighbors_{};  ///< slots of the bricks around, or -1
    std::array<std::vector<float>, 6> tensor_;  ///< [component][cell]
    std::vector<float> trace_;                  ///< [cell]
    std::vector<float> depth_;                  ///< [cell][NearFieldWindow::padded]
};

}  // namespace hairbake
