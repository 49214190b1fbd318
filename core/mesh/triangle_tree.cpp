#include "core/mesh/triangle_tree.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace hairbake {
namespace {

constexpr std::uint32_t kLeaf = 4;

using Corners = std::array<Vec3d, 3>;

Corners corners_of(const TriangleMesh& mesh, std::uint32_t triangle) {
    const auto& t = mesh.triangles[triangle];
    return {Vec3d(mesh.positions[t[0]]), Vec3d(mesh.positions[t[1]]), Vec3d(mesh.positions[t[2]])};
}

Vec3d smaller(const Vec3d& a, const Vec3d& b) { return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)}; }
Vec3d larger(const Vec3d& a, const Vec3d& b) { return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}; }

double square(const Vec3d& a) { return dot(a, a); }

/// Nearest point of the segment from a to b.
Vec3d nearest_on_segment(const Vec3d& a, const Vec3d& b, const Vec3d& p) {
    const Vec3d along = b - a;
    const double s = square(along);
    return a + along * (s > 0 ? std::clamp(dot(p - a, along) / s, 0.0, 1.0) : 0.0);
}

/// Nearest point of the triangle: the foot point where it lies inside, else on the nearest side.
Vec3d nearest_on_triangle(const Corners& c, const Vec3d& normal, const Vec3d& p) {
    bool inside = true;
    for (std::size_t k = 0; k < 3; ++k) inside &= dot(cross(c[(k + 1) % 3] - c[k], p - c[k]), normal) >= 0;
    if (inside) return p - normal * dot(p - c[0], normal);
    Vec3d best = nearest_on_segment(c[0], c[1], p);
    for (const Vec3d& other : {nearest_on_segment(c[1], c[2], p), nearest_on_segment(c[2], c[0], p)})
        if (square(other - p) < square(best - p)) best = other;
    return best;
}

}  // namespace

TriangleTree::TriangleTree(const TriangleMesh& mesh) : mesh_(mesh) {
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const Corners c = corners_of(mesh, t);
        if (square(cross(c[1] - c[0], c[2] - c[0])) > 0) order_.push_back(t);
    }
    nodes_.reserve(order_.size());
    if (!order_.empty()) build(0, static_cast<std::uint32_t>(order_.size()));
}

void TriangleTree::build(std::uint32_t begin, std::uint32_t end) {
    const std::size_t self = nodes_.size();
    Node& node = nodes_.emplace_back();
    Corners c = corners_of(mesh_, order_[begin]);
    Box box{c[0], c[0]}, middles{c[0] + c[1] + c[2], c[0] + c[1] + c[2]};
    for (std::uint32_t i = begin; i < end; ++i) {
        c = corners_of(mesh_, order_[i]);
        for (const Vec3d& p : c) box = {smaller(box.low, p), larger(box.high, p)};
        const Vec3d middle = c[0] + c[1] + c[2];
        middles = {smaller(middles.low, middle), larger(middles.high, middle)};
    }
    node.box = box;
    if (end - begin <= kLeaf) {
        node.begin = begin;
        node.count = end - begin;
        return;
    }
    const Vec3d side = middles.high - middles.low;
    const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
    const auto middle = [&](std::uint32_t t) {
        const Corners m = corners_of(mesh_, t);
        return m[0][axis] + m[1][axis] + m[2][axis];
    };
    const std::uint32_t half = begin + (end - begin) / 2;  // halves: the depth is the logarithm, whatever the mesh
    std::nth_element(order_.begin() + begin, order_.begin() + half, order_.begin() + end,
                     [&](std::uint32_t a, std::uint32_t b) {
                         const double ma = middle(a), mb = middle(b);
                         return ma != mb ? ma < mb : a < b;
                     });
    build(begin, half);
    nodes_[self].second = static_cast<std::uint32_t>(nodes_.size());
    build(half, end);
}

void TriangleTree::offer(std::uint32_t triangle, const Vec3d& p, std::optional<Nearest>& best, double& limit) const {
    const Corners c = corners_of(mesh_, triangle);
    const Vec3d normal = normalized(cross(c[1] - c[0], c[2] - c[0]));
    const Vec3d point = nearest_on_triangle(c, normal, p);
    const double distance = length(point - p);
    if (distance > limit) return;
    // Triangles that share the nearest edge or corner are equally near: only the one that faces p squarely tells on
    // which side of the surface p lies.
    const double rounding = 1e-9 * limit;
    if (best && distance > best->distance - rounding) {
        if (distance > best->distance + rounding) return;
        const double was = std::abs(dot(p - best->point, best->normal)), is = std::abs(dot(p - point, normal));
        if (is < was || (is == was && triangle > best->triangle)) return;
    }
    best = {distance, point, normal, triangle};
    limit = std::min(limit, distance * (1 + 1e-9) + 1e-300);
}

std::optional<TriangleTree::Nearest> TriangleTree::nearest(const Vec3d& p, double reach) const {
    std::optional<Nearest> best;
    if (nodes_.empty()) return best;
    double limit = reach;
    std::array<std::uint32_t, 64> stack;
    std::size_t depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
        const Node& node = nodes_[stack[--depth]];
        const Vec3d outside = larger(Vec3d(0.0), larger(node.box.low - p, p - node.box.high));
        if (square(outside) > limit * limit * (1 + 1e-9)) continue;
        for (std::uint32_t k = 0; k < node.count; ++k) offer(order_[node.begin + k], p, best, limit);
        if (node.count > 0) continue;
        stack[depth++] = node.second;
        stack[depth++] = static_cast<std::uint32_t>(&node - nodes_.data()) + 1;
    }
    return best;
}

}  // namespace hairbake
