// The density grid as a file of OpenVDB.
#pragma once

#include <filesystem>

#include "core/output/file_sink.h"
#include "core/volume/density_grid.h"

namespace hairbake {

/// density.vdb: one grid "density" (density_grid.h tells unit and place), what the sweep walked. The encoded file is in
/// memory as a whole before it is written. Throws what FileSink throws.
WrittenFile write_density_vdb(const DensityGrid& density, const std::filesystem::path& folder);

}  // namespace hairbake
