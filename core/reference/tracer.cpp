#include "core/reference/tracer.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>

#include "core/base/parallel.h"
#include "core/mesh/grounding.h"
#include "core/reference/crossings.h"
#include "core/reference/own_strand.h"

namespace hairbake {
namespace {

constexpr unsigned kPacket = 16;

/// What the filter knows of the packet under way. Embree hands the context back unchanged.
struct PacketContext {
    RTCIntersectContext embree;
    const StrandScene* scene;
    Vec3f direction;
    std::array<std::uint32_t, kPacket> vertex;
    std::array<AdjacentSegments, kPacket> own;
    std::array<std::vector<std::uint32_t>, kPacket>* hit;  ///< segments met; null: the first hit ends the ray
};

/// Drops hits on a vertex's own adjacent segments and on what its ray enters from inside its own strand; when hits are
/// collected, notes every other one and goes on.
void filter(const RTCFilterFunctionNArguments* arguments) {
    auto& context = *reinterpret_cast<PacketContext*>(arguments->context);
    for (unsigned i = 0; i < arguments->N; ++i) {
        if (arguments->valid[i] != -1) continue;
        const unsigned lane = RTCRayN_id(arguments->ray, arguments->N, i);
        const std::uint32_t segment = context.scene->segment_of(RTCHitN_primID(arguments->hit, arguments->N, i));
        const AdjacentSegments& own = context.own[lane];
        if (own.contains(segment) ||
            enters_from_inside(context.scene->strands(), context.vertex[lane], own, segment, context.direction)) {
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

/// Rays of one direction from up to 16 `origins`. Bit i of `seen`: ray i is traced.
void aim(Packet& packet, const StrandScene& scene, std::span<const Vec3f> origins, const Vec3f& l, unsigned seen) {
    for (unsigned i = 0; i < kPacket; ++i) {
        const Vec3f p = origins[i < origins.size() ? i : 0] * scene.scale();
        packet.valid[i] = (seen >> i & 1) != 0 ? -1 : 0;
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

/// Where the vertices of a packet look past the occluder from (core/mesh/grounding.h).
struct Stand {
    std::vector<Vec3f> origins;
    std::vector<Vec3f> horizons;  ///< normals; zero for a vertex that does not lie on the occluder
};

Stand stand_of(const StrandScene& scene, std::span<const std::uint32_t> vertices,
               std::span<const GroundedPoint> grounded, std::size_t first) {
    Stand stand;
    for (const std::uint32_t v : vertices) stand.origins.push_back(scene.strands().positions[v]);
    stand.horizons.resize(vertices.size());
    for (const GroundedPoint& g : grounded) {
        stand.origins[g.point - first] = g.origin;
        stand.horizons[g.point - first] = g.normal;
    }
    return stand;
}

/// Bit i: vertex i sees past the occluder in direction l.
unsigned past_occluder(const StrandScene& scene, const Stand& stand, const Vec3f& l, Packet& packet) {
    unsigned seen = (1u << stand.origins.size()) - 1;
    if (!scene.occluder()) return seen;
    for (unsigned i = 0; i < stand.origins.size(); ++i)
        if (stand.horizons[i] != Vec3f() && dot(stand.horizons[i], l) <= 0) seen &= ~(1u << i);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    aim(packet, scene, stand.origins, l, seen);
    rtcOccluded16(packet.valid.data(), scene.occluder_scene(), &context, &packet.rays);
    for (unsigned i = 0; i < stand.origins.size(); ++i)
        if (packet.rays.tfar[i] < 0) seen &= ~(1u << i);
    return seen;
}

/// Traces up to 16 vertices in every direction; `out` gets their averages.
void trace_packet(const StrandScene& scene, std::span<const std::uint32_t> vertices, const Stand& stand,
                  std::span<const Vec3d> directions, bool opaque, std::span<float> out) {
    const StrandGeometry& strands = scene.strands();
    std::array<std::vector<std::uint32_t>, kPacket> hit;
    Packet packet;
    rtcInitIntersectContext(&packet.context.embree);
    packet.context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    packet.context.embree.filter = filter;
    packet.context.scene = &scene;
    packet.context.hit = opaque ? nullptr : &hit;
    for (unsigned i = 0; i < vertices.size(); ++i) {
        packet.context.vertex[i] = vertices[i];
        packet.context.own[i] = adjacent_segments(strands, vertices[i]);
    }

    std::vector<Vec3f> positions;
    for (const std::uint32_t v : vertices) positions.push_back(strands.positions[v]);

    std::array<double, kPacket> sum{};
    for (const Vec3d& direction : directions) {
        const Vec3f l(direction);
        packet.context.direction = l;
        const unsigned seen = past_occluder(scene, stand, l, packet);
        aim(packet, scene, positions, l, seen);
        for (auto& list : hit) list.clear();
        rtcOccluded16(packet.valid.data(), scene.scene(), &packet.context.embree, &packet.rays);
        for (unsigned i = 0; i < vertices.size(); ++i) {
            if ((seen >> i & 1) == 0) continue;
            sum[i] += opaque ? (packet.rays.tfar[i] >= 0 ? 1.0 : 0.0)
                             : transmittance_of_crossings(strands, strands.positions[vertices[i]], l, hit[i]);
        }
    }
    for (unsigned i = 0; i < vertices.size(); ++i) out[i] = static_cast<float>(sum[i] / double(directions.size()));
}

std::vector<GroundedPoint> ground_vertices(const StrandScene& scene, std::span<const std::uint32_t> vertices,
                                           Progress& progress) {
    std::vector<Vec3f> positions;
    for (const std::uint32_t v : vertices) positions.push_back(scene.strands().positions[v]);
    const ShadowScale scale = shadow_scale(scene.strands().positions, *scene.occluder());
    return ground_points(positions, *scene.occluder(), scale, progress);
}

}  // namespace

std::vector<float> trace_transmittance(const StrandScene& scene, std::span<const std::uint32_t> vertices,
                                       std::span<const Vec3d> directions, Progress& progress) {
    const auto& opacities = scene.strands().opacities;
    const bool opaque = std::all_of(opacities.begin(), opacities.end(), [](float o) { return o == 1; });
    std::vector<float> average(vertices.size());
    std::vector<GroundedPoint> grounded;
    if (scene.occluder()) grounded = ground_vertices(scene, vertices, progress);
    std::atomic<std::size_t> done{0};
    parallel_for(vertices.size(), kPacket, [&](std::size_t begin, std::size_t end) {
        progress.check();
        const std::size_t count = end - begin;
        const auto is_before = [](const GroundedPoint& g, std::size_t k) { return g.point < k; };
        const auto first = std::lower_bound(grounded.begin(), grounded.end(), begin, is_before);
        const auto last = std::lower_bound(first, grounded.end(), end, is_before);
        const Stand stand = stand_of(scene, vertices.subspan(begin, count), {first, last}, begin);
        trace_packet(scene, vertices.subspan(begin, count), stand, directions, opaque,
                     std::span(average).subspan(begin, count));
        progress.report("reference", 0.5 + 0.5 * double(done += count) / double(vertices.size()));
    });
    return average;
}

}  // namespace hairbake
