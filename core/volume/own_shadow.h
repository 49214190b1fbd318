// How much the grid darkens a vertex by the vertex's own strand, which truly takes no light from it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/hair/strand_geometry.h"
#include "core/volume/grid_frame.h"
#include "core/volume/near_field_window.h"

namespace hairbake {

/// The response of the sweep (direction_sweep.h) to the strand that a vertex lies on. For each voxel near the vertex,
/// and each place of the vertex in its own voxel, a table holds the optical depth that a mass of 1 in that voxel adds:
/// the mean over all directions and all places of the sweep's lattice. Immutable: thread-safe.
class OwnShadow {
public:
    /// Fills the table: a fixed set of samples, so always the same.
    OwnShadow();

    /// Mean optical depths, each weighted with T(l) / A = max(0, 1 + slope . l) of one of the means.
    struct Depth {
        float swept = 0;      ///< what the sweep adds up; docs/math.md, section 10
        float in_window = 0;  ///< the part of F_grid, the near field's sum over the grid
    };

    /// The depths of vertex v's own strand: its pieces within 3 voxels along it, of at most
    /// 1,024 segments on each side.
    ///
    /// slopes: of the means, divided by their averages
    /// depths: of each mean; overwritten
    void depths(const StrandGeometry& strands, const GridFrame& frame, const NearFieldWindow& window, std::uint32_t v,
                std::span<const Vec3f> slopes, std::span<Depth> depths) const;

private:
    static constexpr int reach = 2, side = 2 * reach + 1, offsets = side * side * side;  // voxels
    static constexpr int places = 2;                                                     // in half a voxel, per axis

    /// Of one voxel, for a mass of 1 across the line of sight.
    struct Cell {
        float depth = 0;
        Vec3f direction;                ///< mean of l, not of unit length
        std::array<float, 6> square{};  ///< mean of l l^T: xx yy zz xy xz yz
    };
    struct Samples;
    struct View;
    void add_piece(const View& view, const Vec3f& centre, const Vec3f& axis, float mass, std::span<const Vec3f> slopes,
                   std::span<Depth> depths) const;

    std::vector<Cell> cells_;  ///< [places^3][offsets]
};

}  // namespace hairbake
