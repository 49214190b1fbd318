#include "core/reference/strand_scene.h"

#include <embree3/rtcore.h>

#include <string>

#include "core/base/error.h"

namespace hairbake {
namespace {

/// Embree asks this during a build; false makes it stop.
bool go_on(void* progress, double fraction) {
    auto& told = *static_cast<Progress*>(progress);
    told.report("reference", 0.5 * fraction);
    return !told.cancelled();
}

unsigned char joint_flags(const StrandGeometry& strands, std::uint32_t i) {
    unsigned flags = 0;
    if (i > 0 && strands.segments[i - 1] == Segment::solid) flags |= RTC_CURVE_FLAG_NEIGHBOR_LEFT;
    if (strands.segments[i + 1] == Segment::solid) flags |= RTC_CURVE_FLAG_NEIGHBOR_RIGHT;
    return static_cast<unsigned char>(flags);
}

}  // namespace

StrandScene::StrandScene(const StrandGeometry& strands, Progress& progress) : strands_(strands) {
    for (std::uint32_t i = 0; i < strands.vertex_count(); ++i)
        if (strands.segments[i] == Segment::solid) segment_of_.push_back(i);
    device_ = rtcNewDevice(nullptr);
    if (!device_) throw Error(ErrorKind::internal, "Embree gave no device");
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    rtcSetSceneProgressMonitorFunction(scene_, go_on, &progress);
    attach_curves();
    rtcCommitScene(scene_);
    const RTCError error = rtcGetDeviceError(device_);
    if (error == RTC_ERROR_NONE) return;
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
    progress.check();
    throw Error(error == RTC_ERROR_OUT_OF_MEMORY ? ErrorKind::out_of_resources : ErrorKind::internal,
                "Embree could not build the strand scene (error " + std::to_string(error) + ")");
}

StrandScene::~StrandScene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
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
        for (std::size_t v = 0; v < vertices; ++v) {
            const Vec3f& p = strands_.positions[v];
            points[4 * v] = p.x;
            points[4 * v + 1] = p.y;
            points[4 * v + 2] = p.z;
            points[4 * v + 3] = 0.5f * strands_.widths[v];
        }
        for (std::size_t k = 0; k < segments; ++k) {
            indices[k] = segment_of_[k];
            flags[k] = joint_flags(strands_, segment_of_[k]);
        }
        rtcCommitGeometry(curves);
        rtcAttachGeometryByID(scene_, curves, 0);
    }
    rtcReleaseGeometry(curves);
}

}  // namespace hairbake
