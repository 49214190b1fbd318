#include "core/reference/strand_scene.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/base/error.h"
#include "core/reference/segment_hit.h"

namespace hairbake {
namespace {

/// Embree calls this during a build; false makes it stop.
bool may_continue(void* progress, double fraction) {
    auto& receiver = *static_cast<Progress*>(progress);
    receiver.report(fraction);
    return !receiver.cancelled();
}

float power_of_two_scale(const StrandGeometry& strands) {
    const Vec3f side = strands.bounds_max - strands.bounds_min;
    const float longest = std::max({side.x, side.y, side.z});
    return longest > 0 ? std::ldexp(1.0f, -std::clamp(std::ilogb(longest), -126, 126)) : 1.0f;
}

/// Radius of Embree's curve at an end of segments up to `longest`, in Embree's units. A hit is decided by the squared
/// distance between ray and axis. Its error in single precision is some units of the last place of the squared length
/// of the segment; moving the ray's origin to the segment adds some units of the last place of their distance, which is
/// at most the size of the scene (below 4, since scale() makes its longest side 1 to 2). 16 units are allowed for both;
/// the test StrandScene.* finds no lost hit.
float embree_radius(double radius, double longest) {
    constexpr double unit = 16 * 0x1p-24, size = 4;
    return static_cast<float>(std::sqrt(radius * radius + unit * longest * longest) + unit * size);
}

}  // namespace

StrandScene::StrandScene(const StrandGeometry& strands, Progress& progress, const TriangleMesh* occluder)
    : strands_(strands), occluder_(occluder), scale_(power_of_two_scale(strands)) {
    for (std::uint32_t i = 0; i < strands.vertex_count(); ++i)
        if (strands.segments[i] == Segment::solid) segment_of_.push_back(i);
    device_ = rtcNewDevice(nullptr);
    if (!device_) throw Error(ErrorKind::internal, "Embree gave no device");
    build(progress);
    const RTCError error = rtcGetDeviceError(device_);
    if (error == RTC_ERROR_NONE) return;
    release();
    progress.check();
    throw Error(error == RTC_ERROR_OUT_OF_MEMORY ? ErrorKind::out_of_resources : ErrorKind::internal,
                "Embree could not build the strand scene (error " + std::to_string(error) + ")");
}

StrandScene::~StrandScene() { release(); }

bool StrandScene::confirms(std::uint32_t primitive, const Vec3d& origin, const Vec3d& l) const {
    return ray_meets_segment(strands_, segment_of_[primitive], origin, l);
}

void StrandScene::release() {
    if (occluder_scene_) rtcReleaseScene(occluder_scene_);
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
}

RTCSceneTy* StrandScene::new_scene(Progress& progress) {
    const RTCScene scene = rtcNewScene(device_);
    rtcSetSceneProgressMonitorFunction(scene, may_continue, &progress);
    return scene;
}

void StrandScene::build(Progress& progress) {
    ProgressPart curves = progress.part(0, occluder_ ? 0.9 : 1), triangles = progress.part(0.9, 1);
    scene_ = new_scene(curves);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    attach_curves();
    rtcCommitScene(scene_);
    rtcSetSceneProgressMonitorFunction(scene_, nullptr, nullptr);  // what it told is gone after this function
    if (!occluder_) return;
    occluder_scene_ = new_scene(triangles);
    rtcSetSceneFlags(occluder_scene_, RTC_SCENE_FLAG_ROBUST);  // no ray passes between two adjacent triangles
    attach_triangles();
    rtcCommitScene(occluder_scene_);
    rtcSetSceneProgressMonitorFunction(occluder_scene_, nullptr, nullptr);
}

void StrandScene::attach_curves() {
    if (segment_of_.empty()) return;
    const RTCGeometry curves = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE);
    const std::size_t vertices = strands_.vertex_count(), segments = segment_of_.size();
    auto* points = static_cast<float*>(
        rtcSetNewGeometryBuffer(curves, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 4 * sizeof(float), vertices));
    auto* indices = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(curves, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, sizeof(std::uint32_t), segments));
    auto* flags = static_cast<unsigned char*>(
        rtcSetNewGeometryBuffer(curves, RTC_BUFFER_TYPE_FLAGS, 0, RTC_FORMAT_UCHAR, 1, segments));
    if (points && indices && flags) {
        std::vector<float> longest(vertices, 0);  // of the segments at a vertex, Embree's units
        for (const std::uint32_t i : segment_of_) {
            const float side = length(strands_.positions[i + 1] * scale_ - strands_.positions[i] * scale_);
            longest[i] = std::max(longest[i], side);
            longest[i + 1] = side;
        }
        for (std::size_t v = 0; v < vertices; ++v) {
            const Vec3f p = strands_.positions[v] * scale_;
            points[4 * v] = p.x;
            points[4 * v + 1] = p.y;
            points[4 * v + 2] = p.z;
            points[4 * v + 3] = embree_radius(0.5 * strands_.widths[v] * scale_, longest[v]);
        }
        for (std::size_t k = 0; k < segments; ++k) {
            indices[k] = segment_of_[k];
            // No neighbours: every segment has two round ends and reports every ray that meets it. The strand covers
            // the same region. With neighbours Embree omits hits inside the next segment, so that a ray may seem to
            // leave a strand while it is still inside.
            flags[k] = 0;
        }
        rtcCommitGeometry(curves);
        rtcAttachGeometryByID(scene_, curves, 0);
    }
    rtcReleaseGeometry(curves);
}

void StrandScene::attach_triangles() {
    if (occluder_->triangles.empty()) return;
    const RTCGeometry mesh = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* points = static_cast<Vec3f*>(rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                               sizeof(Vec3f), occluder_->positions.size()));
    auto* indices = static_cast<std::array<std::uint32_t, 3>*>(rtcSetNewGeometryBuffer(
        mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), occluder_->triangles.size()));
    if (points && indices) {
        std::transform(occluder_->positions.begin(), occluder_->positions.end(), points,
                       [&](const Vec3f& p) { return p * scale_; });
        std::copy(occluder_->triangles.begin(), occluder_->triangles.end(), indices);
        rtcCommitGeometry(mesh);
        rtcAttachGeometry(occluder_scene_, mesh);
    }
    rtcReleaseGeometry(mesh);
}

}  // namespace hairbake
