#include "core/volume/occluder_shadow.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/assert.h"
#include "core/mesh/mesh_topology.h"

namespace hairbake {
namespace {

constexpr std::uint32_t kNone = ~0u;
constexpr double kCellsPerSize = 512, kMostCells = 2048;

}  // namespace

/// The cells of one direction. The centre of cell (i, j) has p . across_u = i + 0.5 - half and
/// p . across_v = j + 0.5 - half.
struct OccluderShadow::Raster {
    Vec3d l, across_u, across_v;
    double half;
    int side;

    Raster(const Vec3d& direction, double half_side) : l(direction), half(std::ceil(half_side) + 1) {
        const Vec3d any = std::abs(l.x) < 0.6 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
        across_u = normalized(cross(any, l));
        across_v = cross(l, across_u);
        side = static_cast<int>(2 * half);
    }
    std::size_t cells() const { return static_cast<std::size_t>(side) * static_cast<std::size_t>(side); }
};

OccluderShadow::OccluderShadow(const TriangleMesh& mesh, const ShadowScale& scale, const Vec3f& bounds_min,
                               const Vec3f& bounds_max) {
    const Vec3d diagonal = Vec3d(bounds_max) - Vec3d(bounds_min);
    middle_ = Vec3d(bounds_min) + diagonal * 0.5;
    const double reach =
        0.5 * length(diagonal) + scale.reach() + scale.lift();  // grounded points may lie outside the box
    cell_ = std::max(scale.size / kCellsPerSize, 2 * reach / kMostCells);
    half_side_ = reach / cell_;
    tolerance_ = static_cast<float>(0.5 * scale.lift() / cell_);
    const MeshTopology topology = topology_of(mesh);
    facing_ = !topology.closed ? 0 : topology.inside_out ? -1 : 1;
    for (const Vec3f& p : mesh.positions) positions_.push_back((Vec3d(p) - middle_) / cell_);
    for (const auto& t : mesh.triangles) {
        const std::array<Vec3d, 3> c{positions_[t[0]], positions_[t[1]], positions_[t[2]]};
        const Vec3d across = cross(c[1] - c[0], c[2] - c[0]);
        const double area = length(across);
        if (!(area > 0)) continue;
        triangles_.push_back(t);
        const Vec3d normal = across / area;
        planes_.push_back({Vec3f(normal), static_cast<float>(dot(normal, c[0]))});
    }
}

/// Stores `triangle` in the cells whose centre it covers (edges included) and where it is nearest to the light so far.
void OccluderShadow::draw_triangle(const Raster& raster, std::uint32_t triangle, Scratch& scratch) const {
    std::array<double, 3> u, v, height;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d& c = scratch.projected[triangles_[triangle][k]];
        u[k] = c.x;
        v[k] = c.y;
        height[k] = c.z;
    }
    const double area = (u[1] - u[0]) * (v[2] - v[0]) - (u[2] - u[0]) * (v[1] - v[0]);
    const auto [v_low, v_high] = std::minmax({v[0], v[1], v[2]});
    const double last = raster.side - 1;
    if (area == 0 || v_high < 0 || v_low > last) return;
    const double slope_u = ((height[1] - height[0]) * (v[2] - v[0]) - (height[2] - height[0]) * (v[1] - v[0])) / area;
    const double slope_v = ((height[2] - height[0]) * (u[1] - u[0]) - (height[1] - height[0]) * (u[2] - u[0])) / area;
    const auto [lowest, highest] = std::minmax({height[0], height[1], height[2]});
    for (int j = static_cast<int>(std::ceil(std::max(0.0, v_low))); j <= std::min(last, v_high); ++j) {
        double begin = std::numeric_limits<double>::infinity(), end = -begin;
        for (std::size_t k = 0; k < 3; ++k) {  // where the row crosses the edges
            const std::size_t n = (k + 1) % 3;
            if (std::min(v[k], v[n]) > j || std::max(v[k], v[n]) < j) continue;
            const double part = v[n] == v[k] ? 0 : (j - v[k]) / (v[n] - v[k]);
            const double cut = u[k] + part * (u[n] - u[k]);
            begin = std::min({begin, cut, v[n] == v[k] ? u[n] : cut});
            end = std::max({end, cut, v[n] == v[k] ? u[n] : cut});
        }
        if (!(begin <= last && end >= 0)) continue;
        const int first = static_cast<int>(std::ceil(std::max(0.0, begin)));
        for (int i = first; i <= std::min(last, end); ++i) {
            const double at = height[0] + slope_u * (i - u[0]) + slope_v * (j - v[0]);
            const auto level = static_cast<float>(std::clamp(at, lowest, highest));
            const std::size_t cell =
                static_cast<std::size_t>(j) * static_cast<std::size_t>(raster.side) + static_cast<std::size_t>(i);
            if (scratch.triangle[cell] != kNone && level <= scratch.height[cell]) continue;
            scratch.height[cell] = level;
            scratch.triangle[cell] = triangle;
        }
    }
}

void OccluderShadow::draw(const Raster& raster, const Progress& progress, Scratch& scratch) const {
    scratch.height.resize(raster.cells());
    scratch.triangle.assign(raster.cells(), kNone);
    scratch.projected.resize(positions_.size());
    for (std::size_t i = 0; i < positions_.size(); ++i)
        scratch.projected[i] = {dot(positions_[i], raster.across_u) + raster.half - 0.5,
                                dot(positions_[i], raster.across_v) + raster.half - 0.5, dot(positions_[i], raster.l)};
    const Vec3f l(raster.l * facing_);
    for (std::uint32_t t = 0; t < planes_.size(); ++t) {
        if (t % 256 == 0) progress.check();
        if (facing_ == 0 || dot(planes_[t].normal, l) > 0) draw_triangle(raster, t, scratch);
    }
}

void OccluderShadow::visible(const Points& points, std::span<const Vec3d> directions, const Progress& progress,
                             Scratch& scratch, std::vector<std::uint8_t>& seen) const {
    HAIRBAKE_ASSERT(directions.size() <= 8);
    seen.assign(points.at.size(), 0);
    for (std::size_t k = 0; k < directions.size(); ++k) {
        const Raster raster(directions[k], half_side_);
        draw(raster, progress, scratch);
        const Vec3f l(directions[k]), across_u(raster.across_u), across_v(raster.across_v);
        const auto half = static_cast<float>(raster.half);
        for (std::size_t i = 0; i < points.at.size(); ++i) {
            const Vec3f& p = points.at[i];
            const int u = static_cast<int>(dot(p, across_u) + half), v = static_cast<int>(dot(p, across_v) + half);
            const std::uint32_t triangle = scratch.triangle[static_cast<std::size_t>(v * raster.side + u)];
            bool sees = true;
            if (triangle != kNone) {
                const Plane& plane = planes_[triangle];
                const float above = dot(plane.normal, p) - plane.offset;
                sees = (dot(plane.normal, l) > 0 ? above : -above) >= -tolerance_;
            }
            seen[i] = static_cast<std::uint8_t>(seen[i] | static_cast<unsigned>(sees) << k);
        }
        for (const GroundedPoint& g : points.grounded)
            if (dot(g.normal, l) <= 0) seen[g.point] &= static_cast<std::uint8_t>(~(1u << k));
    }
}

}  // namespace hairbake
