#include "core/volume/vertex_points.h"

namespace hairbake {

VertexPoints::VertexPoints(const TransmittanceScene& scene, const HairVolume& volume, Progress& progress)
    : points_{.positions = volume.sorted.vertex_positions,
              .model_index = volume.sorted.vertices,
              .vectors = {},
              .shadow = nullptr} {
    if (!scene.occluder) return;
    const std::vector<Vec3f>& positions = scene.strands.positions;
    points_.shadow = &shadow_.emplace(positions, *scene.occluder, shadow_scale(positions, *scene.occluder), progress);
}

}  // namespace hairbake
