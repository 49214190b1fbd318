// The occluder's shadow on the points of a model, in the order of a sweep's slots.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/volume/occluder_shadow.h"

namespace hairbake {

/// Immutable after construction: thread-safe.
class PointShadow {
public:
    /// positions: of the model, model space; must outlive this object
    /// scale:     shadow_scale() of the hair and the occluder
    ///
    /// Throws Error(cancelled).
    PointShadow(std::span<const Vec3f> positions, const TriangleMesh& occluder, const ShadowScale& scale,
                Progress& progress);

    const OccluderShadow& occluder() const { return occluder_; }
    /// Slot i stands for position point_of_slot[i], or for none where that is out of range.
    OccluderShadow::Points points(std::span<const std::uint32_t> point_of_slot) const;

private:
    std::span<const Vec3f> positions_;
    std::vector<GroundedPoint> grounded_;  ///< ascending
    OccluderShadow occluder_;
};

}  // namespace hairbake
