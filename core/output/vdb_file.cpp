#include "core/output/vdb_file.h"

namespace hairbake {

WrittenFile write_density_vdb(const DensityGrid& density, const std::filesystem::path& folder) {
    FileSink sink(folder / "density.vdb");
    sink.write(density.encode());
    WrittenFile written = sink.finish();
    written.shape = {density.occupied_voxels()};
    written.content = "grid \"density\" of OpenVDB: opacity * width * strand length per volume, 1 / model unit";
    return written;
}

}  // namespace hairbake
