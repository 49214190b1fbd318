#include "tests/bench/vdb_march.h"

#include <openvdb/math/DDA.h>
#include <openvdb/math/Ray.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>

#include <chrono>
#include <cmath>

#include "core/base/parallel.h"

namespace hairbake::bench {
namespace {

using Ray = openvdb::math::Ray<double>;
using Accessor = openvdb::FloatGrid::ConstAccessor;

/// From the root's children down to the leaves, as the library's own VolumeRayIntersector walks.
using Hdda = openvdb::math::VolumeHDDA<openvdb::FloatTree, Ray, openvdb::FloatTree::RootNodeType::ChildNodeType::LEVEL>;

double optical_depth(Accessor& accessor, Ray ray, const openvdb::CoordBBox& box, double voxel_size,
                     std::vector<Ray::TimeSpan>& spans) {
    spans.clear();
    if (!ray.clip(box)) return 0;
    Hdda hdda;
    hdda.hits(ray, accessor, spans);
    double sum = 0;
    for (const auto& span : spans)
        for (double t = span.t0 + 0.5; t < span.t1; t += 1) sum += openvdb::tools::BoxSampler::sample(accessor, ray(t));
    return sum * voxel_size;
}

}  // namespace

double time_vdb_march(const std::filesystem::path& file, std::span<const Vec3f> positions,
                      std::span<const Vec3d> directions, std::vector<float>& average) {
    openvdb::initialize();
    openvdb::io::File in(file.string());
    in.open();
    const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(in.readGrid("density"));
    const openvdb::CoordBBox box = grid->evalActiveVoxelBoundingBox();
    average.assign(positions.size(), 0);
    const auto begin = std::chrono::steady_clock::now();
    parallel_for(positions.size(), 64, [&](std::size_t first, std::size_t last) {
        Accessor accessor = grid->getConstAccessor();
        std::vector<Ray::TimeSpan> spans;
        for (std::size_t i = first; i < last; ++i) {
            const Vec3f& p = positions[i];
            const openvdb::Vec3d eye = grid->worldToIndex(openvdb::Vec3d(p.x, p.y, p.z));
            double sum = 0;
            for (const Vec3d& l : directions) {
                const Ray ray(eye, openvdb::Vec3d(l.x, l.y, l.z), 0.0, 1e5);
                sum += std::exp(-optical_depth(accessor, ray, box, grid->voxelSize()[0], spans));
            }
            average[i] = static_cast<float>(sum / static_cast<double>(directions.size()));
        }
    });
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace hairbake::bench
