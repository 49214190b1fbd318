#include "core/reference/tracer.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>

#include "core/base/parallel.h"
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

void aim(Packet& packet, const StrandScene& scene, std::span<const std::uint32_t> vertices, const Vec3f& l) {
    for (unsigned i = 0; i < kPacket; ++i) {
        const bool used = i < vertices.size();
        const Vec3f p = scene.strands().positions[vertices[used ? i : 0]] * scene.scale();
        packet.valid[i] = used ? -1 : 0;
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

/// Traces up to 16 vertices in every direction; `out` gets their averages.
void trace_packet(const StrandScene& scene, std::span<const std::uint32_t> vertices, std::span<const Vec3d> directions,
                  bool opaque, std::span<float> out) {
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

    std::array<double, kPacket> sum{};
    for (const Vec3d& direction : directions) {
        const Vec3f l(direction);
        packet.context.direction = l;
        aim(packet, scene, vertices, l);
        for (auto& list : hit) list.clear();
        rtcOccluded16(packet.valid.data(), scene.scene(), &packet.context.embree, &packet.rays);
        for (unsigned i = 0; i < vertices.size(); ++i)
            sum[i] += opaque ? (packet.rays.tfar[i] >= 0 ? 1.0 : 0.0)
                             : transmittance_of_crossings(strands, strands.positions[vertices[i]], l, hit[i]);
    }
    for (unsigned i = 0; i < vertices.size(); ++i) out[i] = static_cast<float>(sum[i] / double(directions.size()));
}

}  // namespace

std::vector<float> trace_transmittance(const StrandScene& scene, std::span<const std::uint32_t> vertices,
                                       std::span<const Vec3d> directions, Progress& progress) {
    const auto& opacities = scene.strands().opacities;
    const bool opaque = std::all_of(opacities.begin(), opacities.end(), [](float o) { return o == 1; });
    std::vector<float> average(vertices.size());
    std::atomic<std::size_t> done{0};
    parallel_for(vertices.size(), kPacket, [&](std::size_t begin, std::size_t end) {
        progress.check();
        const std::size_t count = end - begin;
        trace_packet(scene, vertices.subspan(begin, count), directions, opaque,
                     std::span(average).subspan(begin, count));
        progress.report("reference", 0.5 + 0.5 * double(done += count) / double(vertices.size()));
    });
    return average;
}

}  // namespace hairbake
