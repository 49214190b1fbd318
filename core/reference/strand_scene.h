// The strands as Embree curves, and the occluder as triangles.
#pragma once

#include <vector>

#include "core/base/progress.h"
#include "core/hair/strand_geometry.h"
#include "core/mesh/triangle_mesh.h"

struct RTCDeviceTy;
struct RTCSceneTy;

namespace hairbake {

/// Solid segments as Embree round linear curves (cones with rounded joints), without degenerate segments. Primitive k
/// of geometry 0 is segment segment_of(k). The curves are a little thicker than the strands, by what Embree's single
/// precision can lose (embree_radius): a hit counts only when ray_meets_segment() (segment_hit.h) confirms it, which
/// the filter functions of those who trace the scene must ask. In Embree the model is scaled by scale(). The occluder
/// is an Embree scene of its own, because its rays start elsewhere (core/mesh/grounding.h). Immutable after
/// construction; several threads may trace it.
class StrandScene {
public:
    /// strands, occluder: must outlive the scene; occluder may be null
    ///
    /// Throws Error(out_of_resources), Error(cancelled).
    /// Throws Error(internal) with Embree's error number.
    StrandScene(const StrandGeometry& strands, Progress& progress, const TriangleMesh* occluder = nullptr);
    ~StrandScene();
    StrandScene(const StrandScene&) = delete;
    StrandScene& operator=(const StrandScene&) = delete;

    const StrandGeometry& strands() const { return strands_; }
    RTCSceneTy* scene() const { return scene_; }
    /// Stops light completely; null for none.
    const TriangleMesh* occluder() const { return occluder_; }
    RTCSceneTy* occluder_scene() const { return occluder_scene_; }
    /// A power of two that makes the longest side of the bounds 1 to 2. Embree multiplies up to four lengths: in a
    /// model of 1e-10 or 1e10 units that would leave the range of floats.
    float scale() const { return scale_; }
    std::uint32_t segment_of(std::uint32_t primitive) const { return segment_of_[primitive]; }
    /// Whether a ray that meets Embree's curve `primitive` meets the strand. origin, l: as in ray_meets_segment().
    bool confirms(std::uint32_t primitive, const Vec3d& origin, const Vec3d& l) const;

private:
    void build(Progress& progress);
    void release();
    RTCSceneTy* new_scene(Progress& progress);
    void attach_curves();
    void attach_triangles();

    const StrandGeometry& strands_;
    const TriangleMesh* occluder_;
    float scale_ = 1;
    std::vector<std::uint32_t> segment_of_;
    RTCDeviceTy* device_ = nullptr;
    RTCSceneTy* scene_ = nullptr;
    RTCSceneTy* occluder_scene_ = nullptr;
};

}  // namespace hairbake
