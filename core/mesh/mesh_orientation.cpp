#include "core/mesh/mesh_orientation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/base/bounds.h"
#include "core/mesh/mesh_edges.h"

namespace hairbake {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

/// The triangle beyond a side, and whether both run through the side in one direction, that is, disagree.
struct Neighbour {
    std::uint32_t triangle = none;
    bool disagrees = false;
};

/// Triangles joined by edges.
struct Part {
    std::vector<std::uint32_t> triangles;
    bool closed = true, orientable = true, agrees = true;
};

class Orienter {
public:
    explicit Orienter(TriangleMesh& mesh)
        : mesh_(mesh),
          neighbours_(mesh.triangles.size()),
          closed_(mesh.triangles.size(), true),
          turned_(mesh.triangles.size()),
          seen_(mesh.triangles.size()) {
        join(sorted_edges(mesh));
    }

    MeshOrientation run() {
        for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
            if (!seen_[t]) parts_.push_back(part_from(t));
        for (const Part& part : parts_) settle_disagreement(part);
        for (const Part& part : parts_)  // now all parts that can agree do
            if (part.closed && part.orientable && part.agrees && volume(part) < 0 && !is_hollow(part)) turn(part);
        return apply();
    }

private:
    using Corners = std::array<Vec3d, 3>;

    void join(const std::vector<MeshEdge>& edges) {
        std::vector<std::uint8_t> sides(mesh_.triangles.size());
        for (std::size_t begin = 0, end; begin < edges.size(); begin = end) {
            for (end = begin; end < edges.size() && edges[end].ends() == edges[begin].ends();) ++end;
            const MeshEdge &a = edges[begin], &b = edges[end - 1];
            const bool regular = end - begin == 2 && a.triangle != b.triangle;
            for (std::size_t k = begin; k < end; ++k)
                if (!regular) closed_[edges[k].triangle] = false;
            if (!regular) continue;
            neighbours_[a.triangle][sides[a.triangle]++] = {b.triangle, a.upwards == b.upwards};
            neighbours_[b.triangle][sides[b.triangle]++] = {a.triangle, a.upwards == b.upwards};
        }
        for (std::size_t t = 0; t < sides.size(); ++t)
            if (sides[t] < 3) closed_[t] = false;  // also a triangle without sides
    }

    /// The part of triangle `first`; turned_ then tells which of its triangles disagree with the first one.
    Part part_from(std::uint32_t first) {
        Part part;
        part.triangles.push_back(first);
        seen_[first] = true;
        for (std::size_t k = 0; k < part.triangles.size(); ++k) {
            const std::uint32_t t = part.triangles[k];
            part.closed = part.closed && closed_[t];
            part.agrees = part.agrees && !turned_[t];
            for (const Neighbour& next : neighbours_[t]) {
                if (next.triangle == none) continue;
                const bool turned = turned_[t] != next.disagrees;
                if (seen_[next.triangle]) {
                    part.orientable = part.orientable && turned_[next.triangle] == turned;
                    continue;
                }
                seen_[next.triangle] = true;
                turned_[next.triangle] = turned;
                part.triangles.push_back(next.triangle);
            }
        }
        return part;
    }

    void settle_disagreement(const Part& part) {
        if (part.agrees && part.orientable) return;
        if (!part.orientable) {
            ++unorientable_;
            for (const std::uint32_t t : part.triangles) turned_[t] = false;
            return;
        }
        const bool other_side = part.closed ? volume(part) < 0 : area_turned_minus_kept(part) > 0;
        if (other_side) turn(part);
    }

    void turn(const Part& part) {
        for (const std::uint32_t t : part.triangles) turned_[t] = !turned_[t];
    }

    Corners corners(std::uint32_t triangle) const {
        const auto& t = mesh_.triangles[triangle];
        Corners c{Vec3d(mesh_.positions[t[0]]), Vec3d(mesh_.positions[t[1]]), Vec3d(mesh_.positions[t[2]])};
        if (turned_[triangle]) std::swap(c[1], c[2]);
        return c;
    }
    Vec3d place_of(const Part& part) const { return corners(part.triangles[0])[0]; }

    double volume(const Part& part) const {
        const Vec3d base = place_of(part);  // near the part, for the rounding
        double sum = 0;
        for (const std::uint32_t t : part.triangles) {
            const Corners c = corners(t);
            sum += dot(c[0] - base, cross(c[1] - base, c[2] - base));
        }
        return sum / 6;
    }

    double area_turned_minus_kept(const Part& part) const {
        double sum = 0;
        for (const std::uint32_t t : part.triangles) {
            const Corners c = corners(t);
            const double area = length(cross(c[1] - c[0], c[2] - c[0]));
            sum += turned_[t] ? area : -area;
        }
        return sum;
    }

    /// How often the part winds round `p`: the sum of the solid angles of its triangles, over 4 pi.
    double winding(const Part& part, const Vec3d& p) const {
        double sum = 0;
        for (const std::uint32_t t : part.triangles) {
            Corners c = corners(t);
            for (Vec3d& corner : c) corner -= p;
            const double a = length(c[0]), b = length(c[1]), d = length(c[2]);
            const double below = a * b * d + dot(c[0], c[1]) * d + dot(c[1], c[2]) * a + dot(c[2], c[0]) * b;
            sum += 2 * std::atan2(dot(c[0], cross(c[1], c[2])), below);
        }
        return sum / (4 * std::numbers::pi);
    }

    bool is_near(const Part& part, const Vec3d& p) const {
        Vec3d low = place_of(part), high = low;
        for (const std::uint32_t t : part.triangles)
            for (const Vec3d& corner : corners(t))
                for (int axis = 0; axis < 3; ++axis) {
                    low[axis] = std::min(low[axis], corner[axis]);
                    high[axis] = std::max(high[axis], corner[axis]);
                }
        for (int axis = 0; axis < 3; ++axis)
            if (p[axis] < low[axis] || p[axis] > high[axis]) return false;
        return true;
    }

    /// Whether the part lies inside an odd number of other closed parts.
    bool is_hollow(const Part& part) const {
        const Vec3d p = place_of(part);
        std::size_t around = 0;
        for (const Part& other : parts_) {
            if (&other == &part || !other.closed || !other.orientable || !is_near(other, p)) continue;
            around += std::abs(winding(other, p)) > 0.5;
        }
        return around % 2 == 1;
    }

    MeshOrientation apply() {
        MeshOrientation result{std::move(turned_), 0, unorientable_};
        for (std::size_t t = 0; t < result.turned.size(); ++t)
            if (result.turned[t]) {
                std::swap(mesh_.triangles[t][1], mesh_.triangles[t][2]);
                ++result.turned_triangles;
            }
        return result;
    }

    TriangleMesh& mesh_;
    std::vector<std::array<Neighbour, 3>> neighbours_;
    std::vector<bool> closed_, turned_, seen_;
    std::vector<Part> parts_;
    std::uint64_t unorientable_ = 0;
};

}  // namespace

MeshOrientation orient(TriangleMesh& mesh) { return Orienter(mesh).run(); }

}  // namespace hairbake
