// Points whose transmittance is asked for: hair vertices, points of a receiving surface.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/vec.h"
#include "core/volume/point_shadow.h"

namespace hairbake {

/// Points that ask for light; they stop none. Give them in an order in which neighbours in space are near each other,
/// e.g. brick by brick: the sweep is faster then, and its sums are the same in any order. Refers to its parts, which
/// must outlive it.
struct PointSet {
    std::span<const Vec3f> positions;            ///< [P], grid space; they may lie outside the grid
    std::span<const std::uint32_t> model_index;  ///< [P], index in the model of each point; empty: the same index
    std::span<const Vec3f> vectors;       ///< [P], unit normal or tangent in model axes; empty where none is used
    const PointShadow* shadow = nullptr;  ///< of an occluder on the model's points; null for none

    std::size_t size() const { return positions.size(); }
};

}  // namespace hairbake
