#include "core/volume/density_grid.h"

#include <openvdb/openvdb.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "core/base/digest.h"
#include "core/base/error.h"
#include "core/base/parallel.h"

namespace hairbake {

struct DensityGrid::Impl {
    openvdb::FloatGrid::Ptr grid;
};

namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;
static_assert(Leaf::SIZE == ExtinctionBricks::voxels, "a brick is a leaf");

Leaf* make_leaf(const HairVolume& volume, std::size_t b) {
    const auto place = volume.frame.brick_coordinates(volume.sorted.bricks[b]);
    auto* leaf = new Leaf(openvdb::Coord(8 * place[0], 8 * place[1], 8 * place[2]), 0.0f, false);
    const auto inverse_h = static_cast<float>(1 / volume.frame.voxel_size);
    for (openvdb::Index v = 0; v < Leaf::SIZE; ++v)
        if (const float trace = volume.bricks.trace(b, v); trace > 0) leaf->setValueOn(v, trace * inverse_h);
    return leaf;
}

/// Places the voxels in model space. OpenVDB takes no voxels of a volume below 3e-15 (a side of 1.45e-5). Then the grid
/// stays in voxel space, and its metadata gives the place of the voxels.
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

/// Writes the format of openvdb::io::File to any stream. (io::Stream leaves out the offsets with which readers of large
/// files seek.)
class SeekableArchive : public openvdb::io::Archive {
public:
    void write_grid(std::ostream& stream, const openvdb::GridBase::ConstPtr& grid) const {
        Archive::write(stream, openvdb::GridCPtrVec{grid}, true);
    }
};

/// Replaces the random UUID of the header, by which programs tell files apart, by a digest of the contents.
void replace_tag(std::string& bytes) {
    constexpr std::size_t begin = 8 + 3 * 4 + 1, length = 36;  // after the magic number, three versions and a flag
    const auto dash = [&](std::size_t i) { return bytes.size() > begin + i && bytes[begin + i] == '-'; };
    if (!dash(8) || !dash(13) || !dash(18) || !dash(23))
        throw Error(ErrorKind::internal, "this version of OpenVDB writes an unknown file header");
    std::fill_n(bytes.begin() + begin, length, '0');
    const std::string digest = Digest().add(bytes).hex();
    const std::string tag = digest.substr(0, 8) + '-' + digest.substr(8, 4) + '-' + digest.substr(12, 4) + '-' +
                            digest.substr(16, 4) + '-' + digest.substr(20, 12);
    bytes.replace(begin, length, tag);
}

}  // namespace

DensityGrid::DensityGrid(const HairVolume& volume) : impl_(std::make_unique<Impl>()) {
    openvdb::initialize();
    impl_->grid = openvdb::FloatGrid::create(0.0f);
    impl_->grid->setName("density");
    impl_->grid->setGridClass(openvdb::GRID_FOG_VOLUME);
    place_in_model(volume.frame, *impl_->grid);
    std::vector<Leaf*> leaves(volume.sorted.brick_count());
    parallel_for(leaves.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) leaves[b] = make_leaf(volume, b);
    });
    for (Leaf* leaf : leaves) impl_->grid->tree().addLeaf(leaf);  // the tree takes ownership
}

DensityGrid::~DensityGrid() = default;
DensityGrid::DensityGrid(DensityGrid&&) noexcept = default;
DensityGrid& DensityGrid::operator=(DensityGrid&&) noexcept = default;

std::uint64_t DensityGrid::occupied_voxels() const { return impl_->grid->activeVoxelCount(); }

float DensityGrid::density(int i, int j, int k) const { return impl_->grid->tree().getValue(openvdb::Coord(i, j, k)); }

std::string DensityGrid::encode() const {
    std::ostringstream stream;
    SeekableArchive().write_grid(stream, impl_->grid);
    std::string bytes = std::move(stream).str();
    replace_tag(bytes);
    return bytes;
}

void DensityGrid::write(const std::filesystem::path& file) const {
    const std::string bytes = encode();
    std::ofstream out(file, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.close();
    if (!out) throw Error(ErrorKind::out_of_resources, file.string() + " could not be written");
}

}  // namespace hairbake
