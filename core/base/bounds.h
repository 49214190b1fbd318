// The box around points.
#pragma once

#include <algorithm>
#include <span>

#include "core/base/vec.h"

namespace hairbake {

/// Lowest and highest coordinates; zeros without a point.
struct Bounds {
    Vec3f low, high;
};

inline Bounds bounds_of(std::span<const Vec3f> points) {
    if (points.empty()) return {};
    Vec3f low = points[0], high = low;
    for (const Vec3f& p : points) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    return {low, high};
}

}  // namespace hairbake
