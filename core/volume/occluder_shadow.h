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
/// into a raster of cells of 1/512 of the scale's size (more where the points take more than 2,048 of them), each
/// keeping the triangle nearest to the light at its centre; a point is blocked when it lies more than half of the lift
/// behind the plane of its cell's triangle. So the shadow's depth is exact and its outline right to half a cell,
/// without bias; both sides of a triangle block; nothing depends on the hair's voxels, and the mesh may be of any size.
///
/// The solid voxels of the design (OpenVDB's meshToVolume) were left for this: a root in the voxel beside a solid one
/// would see a horizon that is wrong by up to a voxel, 11 degrees and a tenth of the sky on a head of 9 cm at 256
/// voxels; and a mesh larger than the hair would need a larger grid.
///
/// Immutable after construction; may be asked from several threads, each with a scratch of its own.
class OccluderShadow {
public:
    /// `bounds_min` and `bounds_max` hold every point that will be asked for. Copies what it needs of the mesh.
    OccluderShadow(const TriangleMesh& mesh, const ShadowScale& scale, const Vec3f& bounds_min,
                   const Vec3f& bounds_max);

    /// Points in the order in which visibility is wanted: make one for each order with points().
    struct Points {
        std::vector<Vec3f> at;                ///< in cells, from the middle of the bounds
        std::vector<GroundedPoint> grounded;  ///< with a horizon; their index is into `at`
    };
    /// `at(i)` for i < count: model space. `grounded_of(i)`: the grounded point that i stands for, or null.
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

    /// What one thread needs; reused from call to call.
    struct Scratch {
        std::vector<float> height;            ///< along the direction, of each cell's triangle
        std::vector<std::uint32_t> triangle;  ///< of each cell, or none
        std::vector<Vec3d> projected;         ///< positions of the mesh: cell along u and v, height
    };
    /// Bit k of seen[i]: point i sees the light in directions[k] (unit, at most 8).
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
    double facing_ = 0;     ///< closed: +-1, only triangles whose outside faces the light can be nearest to it; else 0
    std::vector<Vec3d> positions_;                         ///< in cells
    std::vector<std::array<std::uint32_t, 3>> triangles_;  ///< those with an area
    std::vector<Plane> planes_;
};

}  // namespace hairbake
