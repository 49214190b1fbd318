// The transform of a glTF node. Private to core/mesh.
#pragma once

#include <array>

#include "core/base/vec.h"

namespace hairbake {

/// x -> axes * x + origin.
struct GltfTransform {
    std::array<Vec3d, 3> axes{Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)};  ///< images of x, y and z
    Vec3d origin;

    Vec3d vector(const Vec3d& v) const { return axes[0] * v.x + axes[1] * v.y + axes[2] * v.z; }
    Vec3d point(const Vec3d& p) const { return vector(p) + origin; }
    double determinant() const { return dot(axes[0], cross(axes[1], axes[2])); }
    /// A normal of a surface, of any length, on the same side of the moved surface.
    Vec3d normal(const Vec3d& n) const {
        const Vec3d moved =
            cross(axes[1], axes[2]) * n.x + cross(axes[2], axes[0]) * n.y + cross(axes[0], axes[1]) * n.z;
        return determinant() < 0 ? -moved : moved;
    }
    /// First `inner`, then this.
    GltfTransform after(const GltfTransform& inner) const {
        return {{vector(inner.axes[0]), vector(inner.axes[1]), vector(inner.axes[2])}, point(inner.origin)};
    }
};

}  // namespace hairbake
