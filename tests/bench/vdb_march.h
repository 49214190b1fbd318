// The peer that marches rays through the same OpenVDB grid.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "core/base/vec.h"

namespace hairbake::bench {

/// Seconds that OpenVDB's VolumeHDDA with a BoxSampler at steps of one voxel takes for every position in every
/// direction, on all cores, over the grid "density" of a .vdb file. `average` gets the mean of exp(-optical depth), so
/// that the work is not optimised away and can be compared.
double time_vdb_march(const std::filesystem::path& file, std::span<const Vec3f> positions,
                      std::span<const Vec3d> directions, std::vector<float>& average);

}  // namespace hairbake::bench
