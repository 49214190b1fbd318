// The density grid as a file of OpenVDB.
#pragma once

#include <filesystem>

#include "core/output/file_sink.h"
#include "core/volume/density_grid.h"

namespace hairbake {

/// density.vdb: one grid "density" (see density_grid.h for unit and place). The whole encoded file is in memory before
/// it is written.
/// Throws what FileSink throws.
WrittenFile write_density_vdb(const DensityGrid& density, const std::filesystem::path& folder);

}  // namespace hairbake
