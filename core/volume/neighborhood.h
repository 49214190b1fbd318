// A brick and its surroundings, laid out for the near-field correction.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/vec.h"
#include "core/volume/hair_volume.h"

namespace hairbake {

/// Local space is in voxels with its origin at `corner`, one voxel below the brick on every axis. On each axis the
/// brick's voxels are 1 to 8 and its halo is 0 and 9.
///
///   local coordinate  0    0.5   1            9   9.5   10
///   voxel             |    0     |   1 .. 8   |    9    |
///   cell                   |  0  |  1 .. 16   | 17 |
///
/// Pieces lie in cells of half a voxel. Reused from brick to brick; one per thread.
struct Neighborhood {
    static constexpr int side = 10;  ///< voxels
    static constexpr int cell_side = 18;
    static constexpr int cells = cell_side * cell_side * cell_side;

    Vec3f corner;  ///< grid space
    /// Pieces of at most half a voxel by cell, z fastest: cell c holds [begin[c], begin[c + 1]). Arrays are padded for
    /// vector loads.
    std::array<std::uint32_t, cells + 1> begin{};
    std::vector<float> centre_x, centre_y, centre_z;  ///< local space
    std::vector<float> axis_x, axis_y, axis_z;        ///< unit
    std::vector<float> half_length;                   ///< voxels
    std::vector<float> weight;                        ///< opacity * width / h
    std::vector<float> least;                         ///< half of width / h
    std::vector<std::int32_t> segment;                ///< of the model, which owns the piece

    /// Extinction tensors of ExtinctionBricks: [component][voxel], components as there, then the trace.
    std::array<std::vector<float>, ExtinctionBricks::components + 1> tensor;

    static int voxel(int i, int j, int k) { return (i * side + j) * side + k; }
    static int cell(int i, int j, int k) { return (i * cell_side + j) * cell_side + k; }
    /// Cell coordinate of a local coordinate.
    static int cell_of(float local) { return static_cast<int>(2 * local) - 1; }

    /// Fills the neighborhood of a brick.
    ///
    /// brick:     brick number of volume.sorted
    /// opacities: [V], of the model's points
    void collect(const HairVolume& volume, std::size_t brick, std::span<const float> opacities);

private:
    struct Place {
        std::uint32_t slot, voxel, local;  ///< brick number, voxel in it, voxel in this neighborhood
    };

    void find_places(const HairVolume& volume, const std::array<int, 3>& brick);
    void collect_pieces(const SortedStrands& sorted, std::span<const float> opacities);
    /// Calls visit(local position, cell) for the one or two halves of a piece that lie in this neighborhood.
    template <class Visit>
    void for_each_half(const StrandPiece& piece, const Visit& visit) const;
    void reserve(std::size_t count);
    void store(const StrandPiece& piece, const Vec3f& local, const Vec3f& axis, float half, float opacity,
               std::uint32_t at);
    void collect_tensors(const ExtinctionBricks& bricks);

    std::vector<Place> places_;  ///< voxels of the brick and its halo that hold something
};

}  // namespace hairbake
