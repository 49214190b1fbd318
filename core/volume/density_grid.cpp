#include "core/volume/density_grid.h"

#include <openvdb/openvdb.h>

#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/parallel.h"

namespace hairbake {

struct DensityGrid::Impl {
    openvdb::FloatGrid::Ptr grid;
};

namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;
static_assert(Leaf::SIZE == ExtinctionBricks::voxels, "a brick is a leaf");

Leaf* make_leaf(const GridFrame& frame, const SortedStrands& sorted, const ExtinctionBricks& bricks, std::size_t b) {
    const auto place = frame.brick_coordinates(sorted.bricks[b]);
    auto* leaf = new Leaf(openvdb::Coord(8 * place[0], 8 * place[1], 8 * place[2]), 0.0f, false);
    const float* trace = &bricks.trace[b * ExtinctionBricks::voxels];
    const auto inverse_h = static_cast<float>(1 / frame.voxel_size);
    for (openvdb::Index v = 0; v < Leaf::SIZE; ++v)
        if (trace[v] > 0) leaf->setValueOn(v, trace[v] * inverse_h);
    return leaf;
}

/// Places the voxels in model space. OpenVDB takes no voxels of a volume below 3e-15 (a side of 1.45e-5): then the grid
/// stays in voxels, and its metadata tells where they are.
void place_in_model(const GridFrame& frame, openvdb::FloatGrid& grid) {
    const double h = frame.voxel_size;
    const openvdb::Vec3d first =
        openvdb::Vec3d(frame.origin.x, frame.origin.y, frame.origin.z) + openvdb::Vec3d(0.5 * h);
    if (h * h * h < 4e-15) {
        grid.insertMeta("voxel_size", openvdb::DoubleMetadata(h));
        grid.insertMeta("first_voxel_centre", openvdb::Vec3DMetadata(first));
        return;
    }
    auto transform = openvdb::math::Transform::createLinearTransform(h);
    transform->postTranslate(first);
    grid.setTransform(transform);
}

}  // namespace

DensityGrid::DensityGrid(const GridFrame& frame, const SortedStrands& sorted, const ExtinctionBricks& bricks)
    : impl_(std::make_unique<Impl>()) {
    openvdb::initialize();
    impl_->grid = openvdb::FloatGrid::create(0.0f);
    impl_->grid->setName("density");
    impl_->grid->setGridClass(openvdb::GRID_FOG_VOLUME);
    place_in_model(frame, *impl_->grid);
    std::vector<Leaf*> leaves(sorted.brick_count());
    parallel_for(leaves.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) leaves[b] = make_leaf(frame, sorted, bricks, b);
    });
    for (Leaf* leaf : leaves) impl_->grid->tree().addLeaf(leaf);  // the tree owns it from here
}

DensityGrid::~DensityGrid() = default;
DensityGrid::DensityGrid(DensityGrid&&) noexcept = default;
DensityGrid& DensityGrid::operator=(DensityGrid&&) noexcept = default;

std::uint64_t DensityGrid::occupied_voxels() const { return impl_->grid->activeVoxelCount(); }

float DensityGrid::density(int i, int j, int k) const { return impl_->grid->tree().getValue(openvdb::Coord(i, j, k)); }

void DensityGrid::write(const std::filesystem::path& file) const {
    try {
        openvdb::io::File out(file.string());
        out.write({impl_->grid});
        out.close();
    } catch (const openvdb::Exception& error) {
        throw Error(ErrorKind::out_of_resources, file.string() + ": could not be written: " + error.what());
    }
}

}  // namespace hairbake
