#include "core/mesh/polygon_cut.h"

#include <GL/glu.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <numbers>
#include <tuple>

namespace hairbake {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

void append_fan(std::span<const std::uint32_t> polygon, std::size_t first, std::vector<Triangle>& triangles) {
    const std::size_t count = polygon.size();
    const auto corner = [&](std::size_t k) { return polygon[(first + k) % count]; };
    for (std::size_t k = 1; k + 1 < count; ++k) {
        const std::uint32_t a = corner(0), b = corner(k), c = corner(k + 1);
        if (a != b && b != c && c != a) triangles.push_back({a, b, c});
    }
}

/// Twice the area, along the polygon's mean normal.
Vec3d newell_normal(std::span<const Vec3d> corners) {
    Vec3d sum;
    for (std::size_t k = 0; k < corners.size(); ++k) sum += cross(corners[k], corners[(k + 1) % corners.size()]);
    return sum;
}

/// Twice the areas of the fan's triangles.
double fan_area(std::span<const Vec3d> corners) {
    double sum = 0;
    for (std::size_t k = 1; k + 1 < corners.size(); ++k)
        sum += length(cross(corners[k] - corners[0], corners[k + 1] - corners[0]));
    return sum;
}

/// Whether the outline, seen along `normal` (unit), turns left at every corner, and once round in all.
bool is_convex(std::span<const Vec3d> corners, const Vec3d& normal) {
    std::vector<Vec3d> sides;
    for (std::size_t k = 0; k < corners.size(); ++k) {
        const Vec3d side = corners[(k + 1) % corners.size()] - corners[k];
        const Vec3d flat = side - normal * dot(side, normal);
        if (dot(flat, flat) > 0) sides.push_back(flat);
    }
    double turning = 0;
    for (std::size_t k = 0; k < sides.size(); ++k) {
        const Vec3d &a = sides[k], &b = sides[(k + 1) % sides.size()];
        const double sine = dot(cross(a, b), normal), cosine = dot(a, b);
        const double rounding = 1e-7 * std::sqrt(dot(a, a) * dot(b, b));  // of single precision
        if (sine < -rounding || (sine < rounding && cosine < 0)) return false;
        turning += std::atan2(std::max(sine, 0.0), cosine);
    }
    return turning < 3 * std::numbers::pi;
}

}  // namespace

/// GLU's tessellator with what its callbacks write.
struct PolygonCutter::Tessellator {
    GLUtesselator* glu = gluNewTess();
    std::span<const std::uint32_t> polygon;
    std::vector<Vec3d> corners;        ///< of the polygon, from its first one
    std::vector<std::uint32_t> found;  ///< places in `polygon`, three for each triangle
    bool crossing = false;

    ~Tessellator() {
        if (glu) gluDeleteTess(glu);
    }

    static void at_vertex(void* corner, void* self) {
        static_cast<Tessellator*>(self)->found.push_back(
            static_cast<std::uint32_t>(static_cast<Vec3d*>(corner) - static_cast<Tessellator*>(self)->corners.data()));
    }
    /// With this callback GLU gives triangles only, no strips or fans.
    static void at_edge_flag(GLboolean, void*) {}
    static void at_error(GLenum, void* self) { static_cast<Tessellator*>(self)->crossing = true; }
    /// GLU asks for the corner at a place where corners coincide or sides cross.
    static void at_combine(GLdouble*, void** data, GLfloat* weight, void** out, void* self) {
        *out = data[0];
        for (int k = 1; k < 4; ++k)
            if (data[k] && weight[k] > 0 && *static_cast<Vec3d*>(data[k]) != *static_cast<Vec3d*>(data[0]))
                static_cast<Tessellator*>(self)->crossing = true;
    }

    void run(const Vec3d& normal) {
        found.clear();
        crossing = false;
        gluTessNormal(glu, normal.x, normal.y, normal.z);
        gluTessBeginPolygon(glu, this);
        gluTessBeginContour(glu);
        for (Vec3d& corner : corners) gluTessVertex(glu, &corner.x, &corner);
        gluTessEndContour(glu);
        gluTessEndPolygon(glu);
    }
    /// Twice the area of the triangles found, along the normal.
    double area(const Vec3d& normal) const {
        double sum = 0;
        for (std::size_t k = 0; k + 2 < found.size(); k += 3)
            sum += std::abs(dot(
                cross(corners[found[k + 1]] - corners[found[k]], corners[found[k + 2]] - corners[found[k]]), normal));
        return sum;
    }
};

PolygonCutter::PolygonCutter() : tessellator_(std::make_unique<Tessellator>()) {
    using Callback = void (*)();
    GLUtesselator* glu = tessellator_->glu;
    if (!glu) throw std::bad_alloc();
    gluTessProperty(glu, GLU_TESS_WINDING_RULE, GLU_TESS_WINDING_NONZERO);
    gluTessCallback(glu, GLU_TESS_VERTEX_DATA, reinterpret_cast<Callback>(&Tessellator::at_vertex));
    gluTessCallback(glu, GLU_TESS_EDGE_FLAG_DATA, reinterpret_cast<Callback>(&Tessellator::at_edge_flag));
    gluTessCallback(glu, GLU_TESS_ERROR_DATA, reinterpret_cast<Callback>(&Tessellator::at_error));
    gluTessCallback(glu, GLU_TESS_COMBINE_DATA, reinterpret_cast<Callback>(&Tessellator::at_combine));
}

PolygonCutter::~PolygonCutter() = default;

PolygonKind PolygonCutter::cut(std::span<const Vec3f> positions, std::span<const std::uint32_t> polygon,
                               std::vector<Triangle>& triangles) {
    if (polygon.size() <= 3) {
        append_fan(polygon, 0, triangles);
        return PolygonKind::convex;
    }
    Tessellator& t = *tessellator_;
    t.corners.clear();
    for (const std::uint32_t i : polygon) t.corners.push_back(Vec3d(positions[i]) - Vec3d(positions[polygon[0]]));
    const Vec3d twice_area = newell_normal(t.corners);
    double extent = 0;
    for (const Vec3d& corner : t.corners) extent = std::max(extent, dot(corner, corner));
    const double size = length(twice_area);
    if (size > 1e-9 * extent) {
        const Vec3d normal = twice_area / size;
        if (is_convex(t.corners, normal)) {
            append_fan(polygon, 0, triangles);
            return PolygonKind::convex;
        }
        t.run(normal);
        if (!t.crossing && std::abs(t.area(normal) - size) <= 1e-5 * size) {
            for (std::size_t k = 0; k + 2 < t.found.size(); k += 3) {
                const Triangle triangle{polygon[t.found[k]], polygon[t.found[k + 1]], polygon[t.found[k + 2]]};
                if (triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0])
                    triangles.push_back(triangle);
            }
            return PolygonKind::concave;
        }
    }
    if (fan_area(t.corners) <= 1e-6 * extent) {  // a line: nothing to cut
        append_fan(polygon, 0, triangles);
        return PolygonKind::convex;
    }
    const auto coordinates = [&](std::uint32_t i) {
        return std::tuple(positions[i].x, positions[i].y, positions[i].z);
    };
    const auto smallest = std::min_element(polygon.begin(), polygon.end(), [&](std::uint32_t a, std::uint32_t b) {
        return coordinates(a) < coordinates(b);
    });
    append_fan(polygon, static_cast<std::size_t>(smallest - polygon.begin()), triangles);
    return PolygonKind::crossing;
}

}  // namespace hairbake
