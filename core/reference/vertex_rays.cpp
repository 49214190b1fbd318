#include "core/reference/vertex_rays.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <limits>

#include "core/reference/crossings.h"
#include "core/reference/own_strand.h"

namespace hairbake {
namespace {

/// Data of the filter for the ray that is being traced. Embree hands the context back unchanged.
struct RayContext {
    RTCIntersectContext embree;
    const StrandScene* scene;
    std::uint32_t vertex;
    Vec3d origin;
    OwnSegments own;
    Vec3f direction;
    std::vector<std::uint32_t>* hit;  ///< segments met; null: the first hit ends the ray
};

/// Drops hits on the surplus of Embree's curves and on the vertex's own strand. Where hits are collected, stores every
/// other hit and lets the ray continue.
void filter(const RTCFilterFunctionNArguments* arguments) {
    auto& context = *reinterpret_cast<RayContext*>(arguments->context);
    const std::uint32_t primitive = RTCHitN_primID(arguments->hit, arguments->N, 0);
    const std::uint32_t segment = context.scene->segment_of(primitive);
    const bool dropped =
        context.own.contains(segment) ||
        enters_from_inside(context.scene->strands(), context.vertex, context.own, segment, context.direction) ||
        !context.scene->confirms(primitive, context.origin, Vec3d(context.direction));
    if (!dropped && !context.hit) return;
    if (!dropped) context.hit->push_back(segment);
    arguments->valid[0] = 0;
}

RTCRay ray_of(const Vec3f& origin, const Vec3f& l) {
    RTCRay ray{};
    ray.org_x = origin.x;
    ray.org_y = origin.y;
    ray.org_z = origin.z;
    ray.dir_x = l.x;
    ray.dir_y = l.y;
    ray.dir_z = l.z;
    ray.tfar = std::numeric_limits<float>::infinity();
    ray.mask = ~0u;
    return ray;
}

}  // namespace

VertexRays::VertexRays(const StrandScene& scene, Progress& progress)
    : scene_(scene),
      opaque_(std::all_of(scene.strands().opacities.begin(), scene.strands().opacities.end(),
                          [](float o) { return o == 1; })) {
    if (!scene.occluder()) return;
    const auto& positions = scene.strands().positions;
    grounded_ = ground_points(positions, *scene.occluder(), shadow_scale(positions, *scene.occluder()), progress);
}

/// Whether no occluder is in the way. A vertex on the occluder starts from its grounded place.
bool VertexRays::past_occluder(std::uint32_t vertex, const Vec3f& l) const {
    Vec3f origin = scene_.strands().positions[vertex];
    const auto ground = std::lower_bound(grounded_.begin(), grounded_.end(), vertex,
                                         [](const GroundedPoint& g, std::uint32_t v) { return g.point < v; });
    if (ground != grounded_.end() && ground->point == vertex) {
        if (dot(ground->normal, l) <= 0) return false;
        origin = ground->origin;
    }
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay ray = ray_of(origin * scene_.scale(), l);
    rtcOccluded1(scene_.occluder_scene(), &context, &ray);
    return ray.tfar >= 0;
}

float VertexRays::transmittance(std::uint32_t vertex, const Vec3d& direction) const {
    const StrandGeometry& strands = scene_.strands();
    const Vec3f l(direction);
    if (scene_.occluder() && !past_occluder(vertex, l)) return 0;
    std::vector<std::uint32_t> hit;
    RayContext context{{},
                       &scene_,
                       vertex,
                       Vec3d(strands.positions[vertex]),
                       own_segments(strands, vertex),
                       l,
                       opaque_ ? nullptr : &hit};
    rtcInitIntersectContext(&context.embree);
    context.embree.filter = filter;
    RTCRay ray = ray_of(strands.positions[vertex] * scene_.scale(), l);
    rtcOccluded1(scene_.scene(), &context.embree, &ray);
    if (opaque_) return ray.tfar >= 0 ? 1.0f : 0.0f;
    return transmittance_of_crossings(strands, strands.positions[vertex], l, hit);
}

}  // namespace hairbake
