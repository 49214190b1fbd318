// The shadow of a mesh that stops light completely, at many points in many directions.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/mesh/grounding.h"
#include "core/mesh/triangle_mesh.h"

namespace hairbake {

/// A point sees the light in direction l unless a triangle is in the way. For each direction the mesh is drawn along l
/// into a raster. A cell is 1/512 of the scale's size, or larger where the points would take more than 2,048 cells. It
/// keeps the triangle nearest to the light at its centre. A point is blocked when it lies more than half of the lift
/// behind the plane of its cell's triangle. So the shadow's depth is exact, and its outline is right to half a cell
/// without bias. Both sides of a triangle block. The result does not depend on the hair's voxels, and the mesh may have
/// any size. See docs/math.md, "Occluders".
///
/// Solid voxels (OpenVDB's meshToVolume) are less exact: a root in the voxel beside a solid one sees a horizon that is
/// wrong by up to a voxel, which is 11 degrees and a tenth of the sky on a head of 9 cm at 256 voxels. And a mesh
/// larger than the hair would need a larger grid.
///
/// Immutable after construction; several threads may use it, each with a scratch of its own.
class OccluderShadow {
public:
    /// Copies what it needs of the mesh. Every point that visible() gets must lie in the box from `bounds_min` to
    /// `bounds_max`.
    OccluderShadow(const TriangleMesh& mesh, const ShadowScale& scale, const Vec3f& bounds_min,
                   const Vec3f& bounds_max);

    /// Points in the order of visible(): make one for each order with points().
    struct Points {
        std::vector<Vec3f> at;                ///< in cells, from the middle of the bounds
        std::vector<GroundedPoint> grounded;  ///< with a horizon; their index is into `at`
    };
    /// count:       number of points
    /// at:          at(i) is the position of point i, model space
    /// grounded_of: grounded_of(i) points to the GroundedPoint of point i, or is null
    template <class At, class GroundedOf>
    Points points(std::size_t count, const At& at, const GroundedOf& grounded_of) const {
        Points result;
        result.at.resize(count);
        for (std::size_t i = 0; i < count; ++i) {
            const GroundedPoint* ground = grounded_of(i);
            result.at[i] = to_cells(ground ? ground->origin : at(i));
            if (ground) result.grounded.push_back({static_cast<std::uint32_t>(i), ground->origin, ground->normal});
        }
        return result;
    }

    /// Buffers of one thread, reused from call to call.
    struct Scratch {
        std::vector<float> height;            ///< along the direction, of each cell's triangle
        std::vector<std::uint32_t> triangle;  ///< of each cell, or none
        std::vector<Vec3d> projected;         ///< positions of the mesh: cell along u and v, height
    };
    /// Finds which points see the light.
    ///
    /// directions: unit, at most 8
    /// seen:       [points], bit k of seen[i]: point i sees the light in directions[k]
    ///
    /// Throws Error(cancelled).
    void visible(const Points& points, std::span<const Vec3d> directions, const Progress& progress, Scratch& scratch,
                 std::vector<std::uint8_t>& seen) const;

private:
    struct Raster;
    /// In cells: n . p > offset on the outer side.
    struct Plane {
        Vec3f normal;
        float offset;
    };

    Vec3f to_cells(const Vec3f& p) const { return Vec3f((Vec3d(p) - middle_) / cell_); }
    void draw(const Raster& raster, const Progress& progress, Scratch& scratch) const;
    void draw_triangle(const Raster& raster, std::uint32_t triangle, Scratch& scratch) const;

    Vec3d middle_;
    double cell_ = 1;       ///< model units
    float tolerance_ = 0;   ///< cells
    double half_side_ = 1;  ///< of the raster, cells
    double facing_ = 0;     ///< +-1 for a closed mesh: only triangles whose outside faces the light are drawn; else 0
    std::vector<Vec3d> positions_;                         ///< in cells
    std::vector<std::array<std::uint32_t, 3>> triangles_;  ///< those with an area
    std::vector<Plane> planes_;
};

}  // namespace hairbake
