// An environment as a few directions that its own light chooses.
#pragma once

#include <cstddef>
#include <vector>

#include "core/base/progress.h"
#include "core/environment/directional_light.h"
#include "core/environment/light_set.h"

namespace hairbake {

/// A light of no size.
struct ClusteredLight {
    Vec3d direction;  ///< unit, towards the light
    Vec3d flux;       ///< RGB, radiance times steradian
};

/// Cells along a quarter of a great circle in the LightSet that is clustered: some 21,000 lights, 1.4 degrees apart.
inline constexpr int clustered_resolution = 64;

/// Gathers `lights` in at most `count` clusters by weighted k-means on the sphere. The weight of a light is 0.85 times
/// its share of the flux (Rec. 709 luminance) and 0.15 times an equal share, so that dark parts of the sky get clusters
/// too. The first centre is the heaviest light; each further one is drawn by k-means++ with a fixed seed. So a sun has a
/// cluster of its own. A cluster's flux is the sum of its members', so no energy is lost; its direction is the weighted
/// mean. Fewer lights than `count` are returned as they are. The same for any thread count.
/// Arthur and Vassilvitskii 2007, k-means++.
/// Throws Error(cancelled).
std::vector<ClusteredLight> cluster_lights(const LightSet& lights, std::size_t count, const Progress& progress);

/// A cluster of its own for each of the request's lights: these have no size.
std::vector<ClusteredLight> as_clusters(const std::vector<DirectionalLight>& lights);

}  // namespace hairbake
