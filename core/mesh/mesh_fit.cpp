#include "core/mesh/mesh_fit.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <optional>

#include "core/base/bounds.h"
#include "core/base/parallel.h"
#include "core/base/short_number.h"
#include "core/mesh/grounding.h"
#include "core/mesh/triangle_tree.h"

namespace hairbake {
namespace {

constexpr std::size_t most_points = 100'000, most_roots = 500, most_solid_angles = 20'000'000;
// A root is near the surface within this share of the hair's longest side, or of the mesh's: flat triangles lie so far
// below the curved surface that they stand for. Within a tenth of that it is on the surface.
constexpr double near_of_hair = 0.02, near_of_mesh = 0.002, on_surface = 0.1;
constexpr double clearly_better = 4;  // times nearer
constexpr double odd_size = 30;       // lashes are a tenth of a head, a ponytail is three of them

/// A change of the mesh that would undo an error: each root is moved the other way instead.
struct Change {
    int quarter_turns;  ///< about x: 1 takes y to z
    double scale;
};

/// Longest sides of the boxes.
struct Sizes {
    double hair, mesh;
    double near(const Change& change) const {
        return std::max(near_of_hair * hair, near_of_mesh * mesh * change.scale);
    }
};

double longest_side(const Bounds& box) {
    const Vec3d side = Vec3d(box.high) - Vec3d(box.low);
    return std::max({side.x, side.y, side.z});
}

/// The point that `change` would bring to `p`.
Vec3d before(const Change& change, const Vec3d& p) {
    const Vec3d q = p / change.scale;
    if (change.quarter_turns > 0) return {q.x, q.z, -q.y};
    if (change.quarter_turns < 0) return {q.x, -q.z, q.y};
    return q;
}

std::vector<Vec3d> roots_of(const HairPoints& hair) {
    std::vector<Vec3d> roots;
    const std::size_t strands = hair.strand_begin.empty() ? 0 : hair.strand_begin.size() - 1;
    const std::size_t step = std::max<std::size_t>(1, strands / most_roots);
    for (std::size_t s = 0; s < strands; s += step) roots.emplace_back(hair.positions[hair.strand_begin[s]]);
    return roots;
}

/// The median distance of the roots to the changed mesh; infinite where half of them are not near it.
double root_distance(const TriangleTree& tree, const std::vector<Vec3d>& roots, const Change& change,
                     const Sizes& sizes) {
    std::vector<double> distances(roots.size(), std::numeric_limits<double>::infinity());
    parallel_for(roots.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            if (const auto nearest = tree.nearest(before(change, roots[i]), sizes.near(change) / change.scale))
                distances[i] = nearest->distance * change.scale;
    });
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    return *middle;
}

/// The change that brings the roots nearest to the surface, if it is clearly better than none (`distance`).
std::optional<Change> helpful_change(const TriangleTree& tree, const std::vector<Vec3d>& roots, const Sizes& sizes,
                                     double distance) {
    constexpr std::array scales{1.0, 100.0, 0.01, 10.0, 0.1, 1000.0, 0.001, 2.54, 1 / 2.54, 39.37, 1 / 39.37};
    std::optional<Change> best;
    double least = distance / clearly_better;
    for (const double scale : scales)
        for (const int turns : {0, -1, 1}) {
            const double found = root_distance(tree, roots, {turns, scale}, sizes);
            if (!(found < least)) continue;
            best = {turns, scale};
            least = found;
        }
    return best;
}

std::string change_text(const Change& change) {
    std::string text;
    if (change.scale != 1)
        text = change.scale > 1 ? short_number(change.scale) + " times larger"
                                : short_number(1 / change.scale) + " times smaller";
    if (change.quarter_turns != 0)
        text += std::string(text.empty() ? "" : " and ") + "turned by " + (change.quarter_turns < 0 ? "-90" : "90") +
                " degrees about x (" +
                (change.quarter_turns < 0 ? "the mesh is z-up, the hair y-up" : "the mesh is y-up, the hair z-up") +
                ")";
    return text;
}

/// The distance of two boxes.
double gap(const Bounds& a, const Bounds& b) {
    Vec3d apart;
    for (int axis = 0; axis < 3; ++axis)
        apart[axis] = std::max({0.0, double(a.low[axis]) - b.high[axis], double(b.low[axis]) - a.high[axis]});
    return length(apart);
}

std::string box_text(const Bounds& box) {
    const Vec3d side = Vec3d(box.high) - Vec3d(box.low);
    const auto number = [](double value) {
        char buffer[32];
        std::snprintf(buffer, sizeof buffer, "%.3g", value);
        return std::string(buffer);
    };
    return number(side.x) + " x " + number(side.y) + " x " + number(side.z);
}

void warn_of_place(const TriangleTree& tree, const TriangleMesh& mesh, const HairPoints& hair, MeshFit& fit) {
    const Bounds hair_box = bounds_of(hair.positions), mesh_box = bounds_of(mesh.positions);
    const Sizes sizes{longest_side(hair_box), longest_side(mesh_box)};
    const std::vector<Vec3d> roots = roots_of(hair);
    if (!(sizes.hair > 0) || !(sizes.mesh > 0) || roots.empty()) return;
    const double distance = root_distance(tree, roots, {0, 1}, sizes);
    if (distance <= on_surface * sizes.near({0, 1})) return;
    const std::string boxes = "its box is " + box_text(mesh_box) + ", the hair's is " + box_text(hair_box);
    if (const auto change = helpful_change(tree, roots, sizes, distance)) {
        fit.warnings.push_back("the hair's roots are not on it, but would be if it were " + change_text(*change) +
                               "; " + boxes + "; bring both to one unit and frame");
        return;
    }
    if (std::isfinite(distance)) return;  // the hair grows on it
    const double ratio = sizes.mesh / sizes.hair;
    if (ratio >= odd_size || ratio <= 1 / odd_size)
        fit.warnings.push_back("it is " + short_number(std::round(ratio > 1 ? ratio : 1 / ratio)) + " times " +
                               (ratio > 1 ? "larger" : "smaller") + " than the hair (" + boxes +
                               "); is its unit that of the hair?");
    else if (const double apart = gap(hair_box, mesh_box); apart > std::max(sizes.hair, sizes.mesh))
        fit.warnings.push_back("it lies " + short_number(std::round(apart / sizes.hair * 10) / 10) +
                               " times the hair's size away from the hair; is its frame that of the hair?");
}

/// How often the mesh winds round `p`: the sum of the solid angles of its triangles, over 4 pi. Inside an open head it is
/// about 1, too.
double winding(const TriangleMesh& mesh, const Vec3d& p) {
    double sum = 0;
    for (const auto& t : mesh.triangles) {
        const Vec3d c[3] = {Vec3d(mesh.positions[t[0]]) - p, Vec3d(mesh.positions[t[1]]) - p,
                            Vec3d(mesh.positions[t[2]]) - p};
        const double a = length(c[0]), b = length(c[1]), d = length(c[2]);
        const double below = a * b * d + dot(c[0], c[1]) * d + dot(c[1], c[2]) * a + dot(c[2], c[0]) * b;
        sum += 2 * std::atan2(dot(c[0], cross(c[1], c[2])), below);
    }
    return sum / (4 * std::numbers::pi);
}

/// Every so many points are looked at.
std::size_t step_for(const TriangleMesh& mesh, bool closed, std::size_t points) {
    const std::size_t most =
        closed ? most_points : std::clamp<std::size_t>(most_solid_angles / mesh.triangles.size(), 16, most_points);
    return std::max<std::size_t>(1, (points + most - 1) / most);
}

void count_inside(const TriangleTree& tree, const TriangleMesh& mesh, bool closed, const HairPoints& hair,
                  MeshFit& fit) {
    const Bounds box = bounds_of(mesh.positions);
    const double reach = shadow_scale(hair.positions, mesh).reach();
    const double far = 2 * longest_side(box);  // from a point in the box, the surface is nearer
    const std::size_t step = step_for(mesh, closed, hair.positions.size());
    const std::size_t count = (hair.positions.size() + step - 1) / step;
    std::atomic<std::uint64_t> inside = 0;
    parallel_for(count, closed ? 1024 : 8, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const Vec3d p(hair.positions[k * step]);
            bool in_box = true;
            for (int axis = 0; axis < 3; ++axis)
                in_box = in_box && p[axis] >= box.low[axis] && p[axis] <= box.high[axis];
            const auto nearest = in_box ? tree.nearest(p, far) : std::nullopt;
            if (!nearest || nearest->distance <= reach) continue;
            inside += closed ? dot(p - nearest->point, nearest->normal) < 0 : std::abs(winding(mesh, p)) > 0.5;
        }
    });
    fit.looked_at = count;
    fit.inside = inside;
    if (2 * fit.inside < fit.looked_at || fit.looked_at == 0) return;
    const std::string all = std::to_string(fit.looked_at);
    fit.warnings.push_back((fit.inside == fit.looked_at ? "all " + all : std::to_string(fit.inside) + " of " + all) +
                           " vertices of the hair" + (step > 1 ? " that were looked at" : "") + " lie inside it" +
                           (closed ? ", where A is 0" : ", where little light comes"));
}

}  // namespace

MeshFit fit_of(const TriangleMesh& mesh, bool closed, const HairPoints& hair) {
    MeshFit fit;
    if (mesh.triangles.empty()) return fit;
    const TriangleTree tree(mesh);
    warn_of_place(tree, mesh, hair, fit);
    count_inside(tree, mesh, closed, hair, fit);
    return fit;
}

std::vector<std::string> place_warnings(const TriangleMesh& mesh, const HairPoints& hair) {
    MeshFit fit;
    if (!mesh.triangles.empty()) warn_of_place(TriangleTree(mesh), mesh, hair, fit);
    return fit.warnings;
}

}  // namespace hairbake
