// The vertices of the hair as points of a sweep.
#pragma once

#include <optional>

#include "core/base/progress.h"
#include "core/volume/hair_volume.h"
#include "core/volume/point_set.h"
#include "core/volume/transmittance.h"

namespace hairbake {

/// The vertices in the order of volume.sorted, with the shadow of the scene's occluder. Immutable: thread-safe.
class VertexPoints {
public:
    /// `scene` and `volume` must outlive this object.
    /// Throws Error(cancelled).
    VertexPoints(const TransmittanceScene& scene, const HairVolume& volume, Progress& progress);
    VertexPoints(const VertexPoints&) = delete;
    VertexPoints& operator=(const VertexPoints&) = delete;

    const PointSet& points() const { return points_; }

private:
    std::optional<PointShadow> shadow_;
    PointSet points_;
};

}  // namespace hairbake
