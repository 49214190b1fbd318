// Cuts polygons into triangles.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/vec.h"

namespace hairbake {

/// How a polygon was cut.
enum class PolygonKind {
    convex,   ///< the fan about its first corner
    concave,  ///< by GLU's tessellator, in the projection along its mean normal
    crossing  ///< its outline crosses itself there, so that it has no one inside: a fan, see PolygonCutter::cut()
};

/// Not thread-safe: a thread has its own.
class PolygonCutter {
public:
    /// Throws std::bad_alloc.
    PolygonCutter();
    ~PolygonCutter();
    PolygonCutter(const PolygonCutter&) = delete;
    PolygonCutter& operator=(const PolygonCutter&) = delete;

    /// Appends the polygon's triangles, which run round as the polygon does. No position is added, and the surface of a
    /// flat polygon does not depend on the corner at which it begins. Triangles that name an index twice are left out.
    ///
    /// The mean normal is the sum of the areas (Newell). A polygon that is not flat is convex or concave as its
    /// projection along this normal is. One whose projection crosses itself becomes the fan about its corner with the
    /// smallest coordinates (x, then y, then z). One whose corners lie in a line counts as convex.
    PolygonKind cut(std::span<const Vec3f> positions, std::span<const std::uint32_t> polygon,
                    std::vector<std::array<std::uint32_t, 3>>& triangles);

private:
    struct Tessellator;
    std::unique_ptr<Tessellator> tessellator_;
};

}  // namespace hairbake
