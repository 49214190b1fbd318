#include "core/reference/tracer.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>

#include "core/base/parallel.h"

namespace hairbake {
namespace {

constexpr unsigned kPacket = 16;

/// One curve that a ray enters, at distance t from the vertex.
struct Crossing {
    std::uint32_t segment;
    float t;
};

/// What the filter knows of the packet under way. Embree hands the context back unchanged.
struct PacketContext {
    RTCIntersectContext embree;
    const StrandScene* scene;
    std::array<AdjacentSegments, kPacket> own;
    std::array<std::vector<Crossing>, kPacket>* crossings;  ///< null: the first hit ends the ray
};

/// Drops hits on a vertex's own adjacent segments; when crossings are collected, notes every other hit and goes on.
void filter(const RTCFilterFunctionNArguments* arguments) {
    auto& context = *reinterpret_cast<PacketContext*>(arguments->context);
    for (unsigned i = 0; i < arguments->N; ++i) {
        if (arguments->valid[i] != -1) continue;
        const unsigned lane = RTCRayN_id(arguments->ray, arguments->N, i);
        const std::uint32_t segment = context.scene->segment_of(RTCHitN_primID(arguments->hit, arguments->N, i));
        if (context.own[lane].contains(segment)) {
            arguments->valid[i] = 0;
        } else if (context.crossings) {
            (*context.crossings)[lane].push_back({segment, RTCRayN_tfar(arguments->ray, arguments->N, i)});
            arguments->valid[i] = 0;
        }
    }
}

/// How far a ray in direction `l` stays inside the curve of `segment` at most.
float chord(const StrandGeometry& strands, std::uint32_t segment, const Vec3f& l) {
    const Vec3f axis = strands.positions[segment + 1] - strands.positions[segment];
    const float axis_length = length(axis), width = std::max(strands.widths[segment], strands.widths[segment + 1]);
    const float sine = length(cross(axis, l)) / axis_length;
    return std::min(axis_length + width, width / std::max(sine, 1e-6f));
}

/// Product of (1 - opacity) over strand crossings. Hits on neighbouring segments of a strand are one crossing when
/// the ray enters the second before it can have left the first.
float transmittance_of(const StrandGeometry& strands, std::vector<Crossing>& crossings, const Vec3f& l) {
    std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) {
        return a.segment != b.segment ? a.segment < b.segment : a.t < b.t;
    });
    float transmittance = 1;
    for (std::size_t k = 0; k < crossings.size(); ++k) {
        const std::uint32_t segment = crossings[k].segment;
        if (k > 0) {
            const Crossing& previous = crossings[k - 1];
            if (previous.segment == segment) continue;  // Embree may offer a primitive twice
            const bool joined = previous.segment + 1 == segment && strands.segments[previous.segment] != Segment::none;
            const float reach = std::max(chord(strands, previous.segment, l), chord(strands, segment, l));
            if (joined && std::abs(previous.t - crossings[k].t) <= reach) continue;
        }
        transmittance *= 1 - 0.5f * (strands.opacities[segment] + strands.opacities[segment + 1]);
    }
    return transmittance;
}

struct Packet {
    alignas(64) std::array<int, kPacket> valid;
    RTCRay16 rays;
    PacketContext context;
};

void aim(Packet& packet, const StrandGeometry& strands, std::span<const std::uint32_t> vertices, const Vec3f& l) {
    for (unsigned i = 0; i < kPacket; ++i) {
        const bool used = i < vertices.size();
        const Vec3f p = strands.positions[vertices[used ? i : 0]];
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
    std::array<std::vector<Crossing>, kPacket> crossings;
    Packet packet;
    rtcInitIntersectContext(&packet.context.embree);
    packet.context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    packet.context.embree.filter = filter;
    packet.context.scene = &scene;
    packet.context.crossings = opaque ? nullptr : &crossings;
    for (unsigned i = 0; i < vertices.size(); ++i) packet.context.own[i] = adjacent_segments(strands, vertices[i]);

    std::array<double, kPacket> sum{};
    for (const Vec3d& direction : directions) {
        const Vec3f l(direction);
        aim(packet, strands, vertices, l);
        for (auto& list : crossings) list.clear();
        rtcOccluded16(packet.valid.data(), scene.scene(), &packet.context.embree, &packet.rays);
        for (unsigned i = 0; i < vertices.size(); ++i)
            sum[i] += opaque ? (packet.rays.tfar[i] >= 0 ? 1.0 : 0.0) : transmittance_of(strands, crossings[i], l);
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
