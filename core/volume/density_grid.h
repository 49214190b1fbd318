// The extinction of a hair volume as an OpenVDB grid, for other programs (density.vdb).
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "core/volume/hair_volume.h"

namespace hairbake {

/// A sparse float grid "density": the trace of the extinction tensors divided by the voxel size. That is opacity *
/// width * strand length per volume, in 1 / model unit. Voxel (i, j, k) of GridFrame has index (i, j, k); leaves are
/// the bricks. The grid's transform places voxel centres in model space. OpenVDB's transforms take no voxels below
/// about 1.5e-5 units; then the metadata voxel_size and first_voxel_centre give the place. Immutable; may be read from
/// several threads.
class DensityGrid {
public:
    /// Copies what it needs of `volume`.
    explicit DensityGrid(const HairVolume& volume);
    ~DensityGrid();
    DensityGrid(DensityGrid&&) noexcept;
    DensityGrid& operator=(DensityGrid&&) noexcept;

    std::uint64_t occupied_voxels() const;
    /// Density of a voxel, 0 outside.
    float density(int i, int j, int k) const;
    /// The bytes of a .vdb file. The same grid gives the same bytes: a tag made of the contents replaces the random tag
    /// that OpenVDB puts into each file.
    std::string encode() const;
    /// Writes the bytes of encode() to a file.
    /// Throws Error(out_of_resources) when it cannot be written.
    void write(const std::filesystem::path& file) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace hairbake
