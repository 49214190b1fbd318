// A bounding volume hierarchy over a mesh's triangles, which finds the nearest one.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/vec.h"
#include "core/mesh/triangle_mesh.h"

namespace hairbake {

/// Leaves out triangles without area. Refers to the mesh, which must outlive it. Immutable after construction, so
/// thread-safe.
class TriangleTree {
public:
    explicit TriangleTree(const TriangleMesh& mesh);

    struct Nearest {
        double distance;
        Vec3d point;             ///< on the triangle
        Vec3d normal;            ///< unit, of the triangle, counter-clockwise
        std::uint32_t triangle;  ///< of several at this distance, the one that faces `p` most squarely
    };
    /// The triangle nearest to `p` within `reach` of it.
    std::optional<Nearest> nearest(const Vec3d& p, double reach) const;

private:
    struct Box {
        Vec3d low, high;
    };
    /// Children of an inner node are the next one and `second`; a leaf holds order_[begin, begin + count).
    struct Node {
        Box box;
        std::uint32_t second = 0, begin = 0, count = 0;
    };

    /// Adds the nodes of order_[begin, end).
    void build(std::uint32_t begin, std::uint32_t end);
    /// Replaces `best` and `limit` where the triangle is nearer.
    void offer(std::uint32_t triangle, const Vec3d& p, std::optional<Nearest>& best, double& limit) const;

    const TriangleMesh& mesh_;
    std::vector<std::uint32_t> order_;
    std::vector<Node> nodes_;
};

}  // namespace hairbake
