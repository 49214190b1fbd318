#include "core/reference/tracer.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>

#include "core/base/hemisphere_means.h"
#include "core/base/parallel.h"
#include "core/reference/crossings.h"
#include "core/reference/own_strand.h"

namespace hairbake {
namespace {

constexpr unsigned kPacket = 16;

/// Where rays start: at a vertex of the hair, or at a point of a surface.
struct RayOrigin {
    static constexpr std::uint32_t no_vertex = ~0u;
    Vec3f position;
    std::uint32_t vertex = no_vertex;
    Vec3f normal;  ///< of a surface; zero for a vertex

    bool on_surface() const { return vertex == no_vertex; }
    double cosine(const Vec3d& l) const { return dot(Vec3d(normal), l); }
    /// Whether it looks in direction l.
    bool looks(const Vec3d& l) const { return !on_surface() || cosine(l) > 0; }
};

/// What the filter knows of the packet under way. Embree hands the context back unchanged.
struct PacketContext {
    RTCIntersectContext embree;
    const StrandScene* scene;
    Vec3f direction;
    std::array<std::uint32_t, kPacket> vertex;  ///< or RayOrigin::no_vertex
    std::array<AdjacentSegments, kPacket> own;
    std::array<std::vector<std::uint32_t>, kPacket>* hit;  ///< segments met; null: the first hit ends the ray
};

/// Whether a vertex's ray meets `segment` as a part of the vertex's own strand.
bool is_own(const PacketContext& context, unsigned lane, std::uint32_t segment) {
    const std::uint32_t vertex = context.vertex[lane];
    if (vertex == RayOrigin::no_vertex) return false;
    const AdjacentSegments& own = context.own[lane];
    return own.contains(segment) ||
           enters_from_inside(context.scene->strands(), vertex, own, segment, context.direction);
}

/// Drops hits on a vertex's own adjacent segments and on what its ray enters from inside its own strand; when hits are
/// collected, notes every other one and goes on.
void filter(const RTCFilterFunctionNArguments* arguments) {
    auto& context = *reinterpret_cast<PacketContext*>(arguments->context);
    for (unsigned i = 0; i < arguments->N; ++i) {
        if (arguments->valid[i] != -1) continue;
        const unsigned lane = RTCRayN_id(arguments->ray, arguments->N, i);
        const std::uint32_t segment = context.scene->segment_of(RTCHitN_primID(arguments->hit, arguments->N, i));
        if (is_own(context, lane, segment)) {
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

void aim(Packet& packet, const StrandScene& scene, std::span<const RayOrigin> origins, const Vec3d& direction) {
    const Vec3f l(direction);
    packet.context.direction = l;
    for (unsigned i = 0; i < kPacket; ++i) {
        const RayOrigin& origin = origins[i < origins.size() ? i : 0];
        const Vec3f p = origin.position * scene.scale();
        packet.valid[i] = i < origins.size() && origin.looks(direction) ? -1 : 0;
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

/// Calls visit(origin number, direction number, T) for up to 16 origins and every direction in which they look.
template <class Visit>
void trace_packet(const StrandScene& scene, std::span<const RayOrigin> origins, std::span<const Vec3d> directions,
                  bool opaque, const Visit& visit) {
    const StrandGeometry& strands = scene.strands();
    std::array<std::vector<std::uint32_t>, kPacket> hit;
    Packet packet;
    rtcInitIntersectContext(&packet.context.embree);
    packet.context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    packet.context.embree.filter = filter;
    packet.context.scene = &scene;
    packet.context.hit = opaque ? nullptr : &hit;
    for (unsigned i = 0; i < origins.size(); ++i) {
        packet.context.vertex[i] = origins[i].vertex;
        if (!origins[i].on_surface()) packet.context.own[i] = adjacent_segments(strands, origins[i].vertex);
    }
    for (std::size_t k = 0; k < directions.size(); ++k) {
        aim(packet, scene, origins, directions[k]);
        for (auto& list : hit) list.clear();
        rtcOccluded16(packet.valid.data(), scene.scene(), &packet.context.embree, &packet.rays);
        for (unsigned i = 0; i < origins.size(); ++i) {
            if (packet.valid[i] == 0) continue;
            visit(i, k,
                  opaque ? (packet.rays.tfar[i] >= 0 ? 1.0 : 0.0)
                         : transmittance_of_crossings(strands, origins[i].position, packet.context.direction, hit[i]));
        }
    }
}

/// Traces `count` origins, origin_of(i), and calls visit(i, direction number, T).
template <class OriginOf, class Visit>
void trace_all(const StrandScene& scene, std::size_t count, const OriginOf& origin_of,
               std::span<const Vec3d> directions, Progress& progress, const Visit& visit) {
    const auto& opacities = scene.strands().opacities;
    const bool opaque = std::all_of(opacities.begin(), opacities.end(), [](float o) { return o == 1; });
    std::atomic<std::size_t> done{0};
    parallel_for(count, kPacket, [&](std::size_t begin, std::size_t end) {
        progress.check();
        std::array<RayOrigin, kPacket> origins;
        for (std::size_t i = begin; i < end; ++i) origins[i - begin] = origin_of(i);
        trace_packet(scene, std::span(origins).first(end - begin), directions, opaque,
                     [&](std::size_t i, std::size_t k, double t) { visit(begin + i, k, t); });
        progress.report("reference", 0.5 + 0.5 * double(done += end - begin) / double(count));
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
    trace_all(
        scene, vertices.size(),
        [&](std::size_t i) {
            return RayOrigin{scene.strands().positions[vertices[i]], vertices[i], {}};
        },
        directions, progress, [&](std::size_t i, std::size_t k, double t) { sums.add(i, k, t); });
    return sums.means();
}

std::vector<float> trace_receiver(const StrandScene& scene, const TriangleMesh& receiver,
                                  std::span<const Vec3d> directions, Progress& progress) {
    const auto origin_of = [&](std::size_t i) {
        return RayOrigin{receiver.positions[i], RayOrigin::no_vertex, receiver.normals[i]};
    };
    std::vector<HemisphereSums> sums(receiver.positions.size());
    trace_all(scene, sums.size(), origin_of, directions, progress,
              [&](std::size_t i, std::size_t k, double t) { sums[i].add(t, origin_of(i).cosine(directions[k])); });
    std::vector<float> answers;
    for (const HemisphereSums& sum : sums)
        for (const float mean : sum.means()) answers.push_back(mean);
    return answers;
}

}  // namespace hairbake
