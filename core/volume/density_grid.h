// The extinction as an OpenVDB grid: what other programs read, and the record of what the sweep used.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "core/volume/extinction_bricks.h"
#include "core/volume/grid_frame.h"
#include "core/volume/strand_pieces.h"

namespace hairbake {

/// A sparse float grid "density": the trace of the extinction tensors over the voxel size, that is, opacity * width *
/// strand length per volume, in 1 / model unit; voxel (i, j, k) of GridFrame is index (i, j, k), its centre placed in
/// model space by the grid's transform (by the metadata voxel_size and first_voxel_centre where voxels are smaller than
/// OpenVDB's transforms take, about 1.5e-5 units). Leaves are the bricks. Immutable; may be read from several threads.
class DensityGrid {
public:
    DensityGrid(const GridFrame& frame, const SortedStrands& sorted, const ExtinctionBricks& bricks);
    ~DensityGrid();
    DensityGrid(DensityGrid&&) noexcept;
    DensityGrid& operator=(DensityGrid&&) noexcept;

    std::uint64_t occupied_voxels() const;
    /// Density of a voxel, 0 outside.
    float density(int i, int j, int k) const;
    /// The bytes of a .vdb file. The same grid gives the same bytes: the random tag that OpenVDB puts into each file is
    /// replaced by one made of the contents.
    std::string encode() const;
    /// Writes them to a file. Throws Error(out_of_resources) when it cannot be written.
    void write(const std::filesystem::path& file) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace hairbake
