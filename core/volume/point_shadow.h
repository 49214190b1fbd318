// The occluder's shadow on a set of points, in the order in which a sweep reads them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/volume/occluder_shadow.h"

namespace hairbake {

/// Refers to `positions`, which must outlive it. Immutable after construction; may be asked from several threads.
class PointShadow {
public:
    /// Throws Error(cancelled).
    PointShadow(std::span<const Vec3f> positions, const TriangleMesh& occluder, const ShadowScale& scale,
                Progress& progress);

    const OccluderShadow& occluder() const { return occluder_; }
    /// The slots of a sweep: slot i stands for position point_of_slot[i], or for none where that is out of range.
    OccluderShadow::Points points(std::span<const std::uint32_t> point_of_slot) const;

private:
    std::span<const Vec3f> positions_;
    std::vector<GroundedPoint> grounded_;  ///< ascending
    OccluderShadow occluder_;
};

}  // namespace hairbake
