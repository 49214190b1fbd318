// A line on a grid of texels, cut where it crosses their edges.
#pragma once

#include <cmath>
#include <cstdlib>
#include <limits>

#include "core/base/assert.h"
#include "core/volume/opacity_view.h"

namespace hairbake {

/// Calls visit(x, y, t0, t1) for every texel on the way from a to b. The part of the line from t0 to t1 (0 at a, 1 at
/// b) lies in the texel. The parts follow each other without gaps. Stops when visit returns false. Returns whether it
/// reached b. a and b must have x and y of at least 0.
/// (Amanatides and Woo 1987, with counted steps, so that rounding can neither miss b's texel nor run past it.)
template <class Visit>
bool walk_texels(const LightPoint& a, const LightPoint& b, const Visit& visit) {
    HAIRBAKE_ASSERT(a.x >= 0 && a.y >= 0 && b.x >= 0 && b.y >= 0);
    constexpr float never = std::numeric_limits<float>::infinity();
    int x = static_cast<int>(a.x), y = static_cast<int>(a.y);
    int left_x = static_cast<int>(b.x) - x, left_y = static_cast<int>(b.y) - y;
    const int step_x = left_x < 0 ? -1 : 1, step_y = left_y < 0 ? -1 : 1;
    left_x = std::abs(left_x);
    left_y = std::abs(left_y);
    const float per_x = left_x > 0 ? 1 / (b.x - a.x) : 0, per_y = left_y > 0 ? 1 / (b.y - a.y) : 0;
    float t = 0;
    while (left_x + left_y > 0) {
        const float next_x = left_x > 0 ? (static_cast<float>(step_x > 0 ? x + 1 : x) - a.x) * per_x : never;
        const float next_y = left_y > 0 ? (static_cast<float>(step_y > 0 ? y + 1 : y) - a.y) * per_y : never;
        const float next = std::fmax(t, std::fmin(std::fmin(next_x, next_y), 1.0f));
        if (!visit(x, y, t, next)) return false;
        t = next;
        if (next_x < next_y) {
            x += step_x;
            --left_x;
        } else {
            y += step_y;
            --left_y;
        }
    }
    return visit(x, y, t, 1.0f);
}

}  // namespace hairbake
