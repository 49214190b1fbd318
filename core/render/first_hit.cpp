#include "core/render/first_hit.h"

#include <embree3/rtcore.h>

#include <limits>
#include <string>

#include "core/base/error.h"

namespace hairbake {
namespace {

void throw_embree_error(RTCError error) {
    throw Error(error == RTC_ERROR_OUT_OF_MEMORY ? ErrorKind::out_of_resources : ErrorKind::internal,
                "Embree could not build the mesh's scene (error " + std::to_string(error) + ")");
}

RTCRayHit aim(const Vec3f& origin, const Vec3f& direction) {
    RTCRayHit ray{};
    ray.ray.org_x = origin.x;
    ray.ray.org_y = origin.y;
    ray.ray.org_z = origin.z;
    ray.ray.dir_x = direction.x;
    ray.ray.dir_y = direction.y;
    ray.ray.dir_z = direction.z;
    ray.ray.tfar = std::numeric_limits<float>::infinity();
    ray.ray.mask = ~0u;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    return ray;
}

/// Whether the ray meets the scene before its end; the ray then ends there.
bool meets(RTCScene scene, RTCIntersectContext& context, RTCRayHit& ray) {
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene, &context, &ray);
    return ray.hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

/// Data of the filter for the ray that is being traced. Embree hands the context back unchanged.
struct StrandContext {
    RTCIntersectContext embree;
    const StrandScene* strands;
    Vec3d origin, direction;
};

/// Drops hits on the surplus of Embree's curves.
void confirm(const RTCFilterFunctionNArguments* arguments) {
    const auto& context = *reinterpret_cast<const StrandContext*>(arguments->context);
    const std::uint32_t primitive = RTCHitN_primID(arguments->hit, arguments->N, 0);
    if (!context.strands->confirms(primitive, context.origin, context.direction)) arguments->valid[0] = 0;
}

}  // namespace

FirstHits::FirstHits(const StrandScene& strands, const TriangleMesh* mesh) : strands_(strands) {
    if (!mesh || mesh->triangles.empty()) return;
    mesh_ = *mesh;
    device_ = rtcNewDevice(nullptr);
    if (!device_) throw Error(ErrorKind::internal, "Embree gave no device");
    scene_ = rtcNewScene(device_);
    build(mesh_);
    if (const RTCError error = rtcGetDeviceError(device_); error != RTC_ERROR_NONE) {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
        throw_embree_error(error);
    }
}

FirstHits::~FirstHits() {
    if (!device_) return;
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
}

void FirstHits::build(const TriangleMesh& mesh) {
    const RTCGeometry triangles = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(triangles, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                               3 * sizeof(float), mesh.positions.size()));
    auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        triangles, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.triangles.size()));
    if (points && indices) {
        for (const Vec3f& p : mesh.positions)
            for (int axis = 0; axis < 3; ++axis) *points++ = p[axis] * strands_.scale();
        for (const auto& triangle : mesh.triangles)
            for (const std::uint32_t corner : triangle) *indices++ = corner;
        rtcCommitGeometry(triangles);
        rtcAttachGeometry(scene_, triangles);
    }
    rtcReleaseGeometry(triangles);
    rtcCommitScene(scene_);
}

Vec3d FirstHits::normal_at(std::uint32_t triangle, double u, double v) const {
    const auto& [a, b, c] = mesh_.triangles[triangle];
    const Vec3d normal =
        Vec3d(mesh_.normals[a]) * (1 - u - v) + Vec3d(mesh_.normals[b]) * u + Vec3d(mesh_.normals[c]) * v;
    return length(normal) > 0 ? normalized(normal) : Vec3d();
}

FirstHit FirstHits::find(const Vec3d& origin, const Vec3d& direction) const {
    FirstHit hit;
    RTCRayHit ray = aim(Vec3f(origin * double(strands_.scale())), Vec3f(direction));
    StrandContext context{{}, &strands_, origin, direction};
    rtcInitIntersectContext(&context.embree);
    context.embree.filter = confirm;
    if (meets(strands_.scene(), context.embree, ray)) {
        hit.kind = FirstHit::Kind::strand;
        hit.strand = {strands_.segment_of(ray.hit.primID), double(ray.hit.u)};
    }
    context.embree.filter = nullptr;
    if (scene_ && meets(scene_, context.embree, ray)) {
        hit.kind = FirstHit::Kind::mesh;
        hit.normal = normal_at(ray.hit.primID, ray.hit.u, ray.hit.v);
        if (hit.normal == Vec3d()) hit.normal = -direction;
    }
    return hit;
}

}  // namespace hairbake
