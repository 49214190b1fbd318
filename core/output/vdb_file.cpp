#include "core/output/vdb_file.h"

#include "core/output/format_table.h"

namespace hairbake {

WrittenFile write_density_vdb(const DensityGrid& density, const std::filesystem::path& folder) {
    FileSink sink(folder / "density.vdb");
    sink.write(density.encode());
    WrittenFile written = sink.finish();
    written.shape = {density.occupied_voxels()};
    written.content = "grid \"density\" of OpenVDB: opacity * width * strand length per volume, 1 / model unit";
    return written;
}

/// An empty model has no density grid: that is a warning.
std::vector<WrittenFile> write_vdb(const OutputContext& context, const StagePart& part) {
    context.progress.check();
    const auto* facts = std::get_if<TransmittanceFacts>(&part.facts);
    if (!facts) return {};
    if (facts->density) return {write_density_vdb(*facts->density, context.folder)};
    context.warnings.push_back("density.vdb is left out: there is no density grid, as no strand has a segment");
    return {};
}

}  // namespace hairbake
