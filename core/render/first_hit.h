// The first surface that a ray from the camera meets.
#pragma once

#include <cstdint>

#include "core/base/vec.h"
#include "core/mesh/triangle_mesh.h"
#include "core/reference/strand_scene.h"

namespace hairbake {

/// A point between the vertices `vertex` and `vertex` + 1 of a strand, at the share `u` of the way in [0, 1].
struct StrandPlace {
    std::uint32_t vertex = 0;
    double u = 0;
};

struct FirstHit {
    enum class Kind { nothing, strand, mesh } kind = Kind::nothing;
    StrandPlace strand;
    Vec3d normal;  ///< unit, of the mesh's surface, interpolated between its vertices
};

/// The strands as round linear curves with their widths, and a mesh as triangles. Strands are opaque to the camera;
/// strand.opacity applies to their shadows alone. Refers to the scene, which must outlive it. Immutable after
/// construction: thread-safe.
class FirstHits {
public:
    /// `mesh` may be null; it is copied.
    /// Throws Error(out_of_resources), Error(internal) with Embree's error code.
    FirstHits(const StrandScene& strands, const TriangleMesh* mesh);
    ~FirstHits();
    FirstHits(const FirstHits&) = delete;
    FirstHits& operator=(const FirstHits&) = delete;

    FirstHit find(const Vec3d& origin, const Vec3d& direction) const;

private:
    void build(const TriangleMesh& mesh);
    /// Interpolated between the vertices' normals; 0 where they cancel.
    Vec3d normal_at(std::uint32_t triangle, double u, double v) const;

    const StrandScene& strands_;
    TriangleMesh mesh_;
    RTCDeviceTy* device_ = nullptr;
    RTCSceneTy* scene_ = nullptr;
};

}  // namespace hairbake
