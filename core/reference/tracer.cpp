#include "core/reference/tracer.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <utility>

#include "core/base/assert.h"
#include "core/base/parallel.h"
#include "core/mesh/grounding.h"
#include "core/reference/crossings.h"
#include "core/reference/own_strand.h"
#include "core/visibility/hemisphere_means.h"

namespace hairbake {
namespace {

constexpr unsigned kPacket = 16;

/// The start of rays: a vertex of the hair, or a point of a surface.
struct RayOrigin {
    static constexpr std::uint32_t no_vertex = ~0u;
    Vec3f position;
    std::uint32_t vertex = no_vertex;
    Vec3f normal;   ///< of a surface; zero for a vertex
    Vec3f stand;    ///< start of the rays against the occluder (core/mesh/grounding.h)
    Vec3f horizon;  ///< normal of the occluder for an origin on it, else zero

    bool on_surface() const { return vertex == no_vertex; }
    double cosine(const Vec3d& l) const { return dot(Vec3d(normal), l); }
    /// Whether l points away from the surface; always true for a vertex.
    bool faces(const Vec3d& l) const { return !on_surface() || cosine(l) > 0; }
    bool is_over_horizon(const Vec3f& l) const { return horizon == Vec3f() || dot(horizon, l) > 0; }
};

/// Data of the filter for the packet that is being traced. Embree hands the context back unchanged.
struct PacketContext {
    RTCIntersectContext embree;
    const StrandScene* scene;
    Vec3f direction;
    std::array<std::uint32_t, kPacket> vertex;  ///< or RayOrigin::no_vertex
    std::array<Vec3d, kPacket> origin;
    std::array<OwnSegments, kPacket> own;
    std::array<std::vector<std::uint32_t>, kPacket>* hit;  ///< segments met; null: the first hit ends the ray
};

/// Whether a vertex's ray meets `segment` as a part of the vertex's own strand.
bool is_own(const PacketContext& context, unsigned lane, std::uint32_t segment) {
    const std::uint32_t vertex = context.vertex[lane];
    if (vertex == RayOrigin::no_vertex) return false;
    const OwnSegments& own = context.own[lane];
    return own.contains(segment) ||
           enters_from_inside(context.scene->strands(), vertex, own, segment, context.direction);
}

/// Drops hits on the surplus of Embree's curves and on a vertex's own strand. Where hits are collected, stores every
/// other hit and lets the ray continue.
void filter(const RTCFilterFunctionNArguments* arguments) {
    auto& context = *reinterpret_cast<PacketContext*>(arguments->context);
    for (unsigned i = 0; i < arguments->N; ++i) {
        if (arguments->valid[i] != -1) continue;
        const unsigned lane = RTCRayN_id(arguments->ray, arguments->N, i);
        const std::uint32_t primitive = RTCHitN_primID(arguments->hit, arguments->N, i);
        const std::uint32_t segment = context.scene->segment_of(primitive);
        if (is_own(context, lane, segment) ||
            !context.scene->confirms(primitive, context.origin[lane], Vec3d(context.direction))) {
            arguments->valid[i] = 0;
        } else if (context.hit) {
            (*context.hit)[lane].push_back(segment);
            arguments->valid[i] = 0;
        }
    }
}

struct Packet {
    alignas(64) std::array<int, kPacket> valid;
    RTCRay16 rays;
    PacketContext context;
};

/// Aims the rays for which lane_is_used(i) at packet.context.direction, from position_of(origin).
template <class PositionOf, class LaneIsUsed>
void aim(Packet& packet, const StrandScene& scene, std::span<const RayOrigin> origins, const PositionOf& position_of,
         const LaneIsUsed& lane_is_used) {
    const Vec3f l = packet.context.direction;
    for (unsigned i = 0; i < kPacket; ++i) {
        const Vec3f p = position_of(origins[i < origins.size() ? i : 0]) * scene.scale();
        packet.valid[i] = i < origins.size() && lane_is_used(i) ? -1 : 0;
        packet.rays.org_x[i] = p.x;
        packet.rays.org_y[i] = p.y;
        packet.rays.org_z[i] = p.z;
        packet.rays.dir_x[i] = l.x;
        packet.rays.dir_y[i] = l.y;
        packet.rays.dir_z[i] = l.z;
        packet.rays.tnear[i] = 0;
        packet.rays.tfar[i] = std::numeric_limits<float>::infinity();
        packet.rays.time[i] = 0;
        packet.rays.mask[i] = ~0u;
        packet.rays.id[i] = i;
        packet.rays.flags[i] = 0;
    }
}

/// Bit i: origin i faces the packet's direction, and no occluder is in the way.
unsigned past_occluder(const StrandScene& scene, std::span<const RayOrigin> origins, const Vec3d& direction,
                       bool occluded, Packet& packet) {
    unsigned seen = 0;
    for (unsigned i = 0; i < origins.size(); ++i)
        if (origins[i].faces(direction) && origins[i].is_over_horizon(packet.context.direction)) seen |= 1u << i;
    if (!occluded) return seen;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    aim(
        packet, scene, origins, [](const RayOrigin& origin) { return origin.stand; },
        [&](unsigned i) { return (seen >> i & 1) != 0; });
    rtcOccluded16(packet.valid.data(), scene.occluder_scene(), &context, &packet.rays);
    for (unsigned i = 0; i < origins.size(); ++i)
        if (packet.rays.tfar[i] < 0) seen &= ~(1u << i);
    return seen;
}

/// The obstacles of all rays of one call.
struct Obstacles {
    const StrandScene& scene;
    bool opaque;    ///< all strands are opaque
    bool occluded;  ///< the scene's occluder counts
};

/// Calls visit(origin number, direction number, T) for up to 16 origins and every direction that they face.
template <class Visit>
void trace_packet(const Obstacles& obstacles, std::span<const RayOrigin> origins, std::span<const Vec3d> directions,
                  const Visit& visit) {
    const StrandScene& scene = obstacles.scene;
    std::array<std::vector<std::uint32_t>, kPacket> hit;
    Packet packet;
    rtcInitIntersectContext(&packet.context.embree);
    packet.context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    packet.context.embree.filter = filter;
    packet.context.scene = &scene;
    packet.context.hit = obstacles.opaque ? nullptr : &hit;
    for (unsigned i = 0; i < origins.size(); ++i) {
        packet.context.vertex[i] = origins[i].vertex;
        packet.context.origin[i] = Vec3d(origins[i].position);
        if (!origins[i].on_surface()) packet.context.own[i] = own_segments(scene.strands(), origins[i].vertex);
    }
    for (std::size_t k = 0; k < directions.size(); ++k) {
        const Vec3f l = packet.context.direction = Vec3f(directions[k]);
        const unsigned seen = past_occluder(scene, origins, directions[k], obstacles.occluded, packet);
        aim(
            packet, scene, origins, [](const RayOrigin& origin) { return origin.position; },
            [&](unsigned i) { return (seen >> i & 1) != 0; });
        for (auto& list : hit) list.clear();
        rtcOccluded16(packet.valid.data(), scene.scene(), &packet.context.embree, &packet.rays);
        for (unsigned i = 0; i < origins.size(); ++i) {
            const auto t = [&] {
                if ((seen >> i & 1) == 0) return 0.0;
                if (obstacles.opaque) return packet.rays.tfar[i] >= 0 ? 1.0 : 0.0;
                return double{transmittance_of_crossings(scene.strands(), origins[i].position, l, hit[i])};
            };
            if (origins[i].faces(directions[k])) visit(i, k, t());
        }
    }
}

/// Sets `stand` and `horizon` of the origins that lie on the scene's occluder.
void stand_on_occluder(const StrandScene& scene, std::span<RayOrigin> origins, Progress& progress) {
    std::vector<Vec3f> positions;
    for (const RayOrigin& origin : origins) positions.push_back(origin.position);
    const ShadowScale scale = shadow_scale(scene.strands().positions, *scene.occluder());
    for (const GroundedPoint& g : ground_points(positions, *scene.occluder(), scale, progress)) {
        origins[g.point].stand = g.origin;
        origins[g.point].horizon = g.normal;
    }
}

std::vector<RayOrigin> origins_of(const StrandScene& scene, std::span<const std::uint32_t> vertices) {
    std::vector<RayOrigin> origins(vertices.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        origins[i].position = scene.strands().positions[vertices[i]];
        origins[i].vertex = vertices[i];
    }
    return origins;
}

/// Traces all origins and calls visit(origin number, direction number, T).
template <class Visit>
void trace_all(const StrandScene& scene, std::vector<RayOrigin> origins, bool occluded,
               std::span<const Vec3d> directions, Progress& progress, const Visit& visit) {
    const auto& opacities = scene.strands().opacities;
    const bool opaque = std::all_of(opacities.begin(), opacities.end(), [](float o) { return o == 1; });
    for (RayOrigin& origin : origins) origin.stand = origin.position;
    if (occluded) stand_on_occluder(scene, origins, progress);
    std::atomic<std::size_t> done{0};
    parallel_for(origins.size(), kPacket, [&](std::size_t begin, std::size_t end) {
        progress.check();
        trace_packet({scene, opaque, occluded}, std::span<const RayOrigin>(origins).subspan(begin, end - begin),
                     directions, [&](std::size_t i, std::size_t k, double t) { visit(begin + i, k, t); });
        progress.report(double(done += end - begin) / double(origins.size()));
    });
}

}  // namespace

std::vector<float> trace_transmittance(const StrandScene& scene, std::span<const std::uint32_t> vertices,
                                       std::span<const Vec3d> directions, Progress& progress) {
    return trace_directional(scene, vertices, directions, 0, false, progress).average;
}

DirectionalMeans trace_directional(const StrandScene& scene, std::span<const std::uint32_t> vertices,
                                   std::span<const Vec3d> directions, int sh_bands, bool bent_cone,
                                   Progress& progress) {
    DirectionalSums sums(vertices.size(), directions, sh_bands, bent_cone);
    trace_all(scene, origins_of(scene, vertices), scene.occluder() != nullptr, directions, progress,
              [&](std::size_t i, std::size_t k, double t) { sums.add(i, k, t); });
    return sums.means();
}

std::vector<float> trace_weighted(const StrandScene& scene, std::span<const std::uint32_t> vertices,
                                  std::span<const Vec3d> directions, const DirectionWeights& weights,
                                  Progress& progress) {
    HAIRBAKE_ASSERT(directions.size() == weights.directions && weights.rows.size() == scene.strands().vertex_count());
    std::vector<double> sums(vertices.size() * weights.components);
    trace_all(scene, origins_of(scene, vertices), scene.occluder() != nullptr, directions, progress,
              [&](std::size_t i, std::size_t k, double t) {
                  const float* weight = weights.of(weights.rows[vertices[i]], k);
                  for (std::size_t c = 0; c < weights.components; ++c)
                      sums[i * weights.components + c] += t * double(weight[c]);
              });
    return {sums.begin(), sums.end()};
}

std::vector<float> trace_receiver(const StrandScene& scene, const TriangleMesh& receiver, bool receiver_is_occluder,
                                  std::span<const Vec3d> directions, Progress& progress) {
    std::vector<RayOrigin> origins(receiver.positions.size());
    for (std::size_t i = 0; i < origins.size(); ++i) {
        origins[i].position = receiver.positions[i];
        origins[i].normal = receiver.normals[i];
    }
    const bool occluded = scene.occluder() && !receiver_is_occluder;
    std::vector<HemisphereSums> sums(origins.size());
    trace_all(scene, std::move(origins), occluded, directions, progress, [&](std::size_t i, std::size_t k, double t) {
        sums[i].add(t, dot(Vec3d(receiver.normals[i]), directions[k]));
    });
    std::vector<float> answers;
    for (const HemisphereSums& sum : sums)
        for (const float mean : sum.means()) answers.push_back(mean);
    return answers;
}

}  // namespace hairbake
