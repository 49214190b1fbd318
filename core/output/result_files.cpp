#include "core/output/result_files.h"

#include <iterator>

#include "core/output/dds_files.h"
#include "core/output/glb_file.h"
#include "core/output/ktx2_files.h"
#include "core/output/map_files.h"
#include "core/output/preview.h"
#include "core/output/raw_maps.h"
#include "core/output/raw_strands.h"
#include "core/output/transmittance_files.h"
#include "core/output/vdb_file.h"

namespace hairbake {
namespace {

void append(std::vector<WrittenFile>& files, std::vector<WrittenFile> more) {
    files.insert(files.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

/// The maps in the containers of half floats.
std::vector<WrittenFile> write_half_maps(const BakeResult& result, const std::filesystem::path& folder,
                                         Progress& progress) {
    const BakeRequest& request = result.request;
    const IrradianceMaps& maps = *result.irradiance;
    const std::string& primaries = result.environment->primaries;
    std::vector<WrittenFile> files;
    if (request.wants("ktx2")) append(files, write_map_ktx2(maps, primaries, folder, progress));
    if (request.wants("dds")) append(files, write_map_dds(maps, folder, progress));
    if (request.wants("raw")) append(files, write_map_raw(maps, primaries, folder, progress));
    return files;
}

/// The hair with its A in every form asked for. An empty model has no density grid: that is a warning.
std::vector<WrittenFile> write_transmittance(BakeResult& result, const std::filesystem::path& folder,
                                             const Progress& progress) {
    const BakeRequest& request = result.request;
    const Transmittance& transmittance = *result.transmittance;
    std::vector<WrittenFile> files;
    if (request.wants("npy")) {
        const TransmittanceSettings& settings = request.transmittance;
        files.push_back(write_transmittance_npy(transmittance.average, folder));
        append(files, write_directional_npy(transmittance, settings.sh_bands, settings.bent_cone,
                                            request.receiver.has_value(), folder));
    }
    if (request.wants("hair")) files.push_back(write_transmittance_hair(*result.hair, transmittance.average, folder));
    progress.check();
    if (request.wants("glb")) files.push_back(write_glb(*result.hair, transmittance, folder));
    progress.check();
    if (request.wants("raw")) append(files, write_strand_raw(*result.hair, transmittance, folder));
    progress.check();
    if (request.wants("vdb")) {
        if (transmittance.density)
            files.push_back(write_density_vdb(*transmittance.density, folder));
        else
            result.warnings.push_back("density.vdb is left out: there is no density grid, as no strand has a segment");
    }
    return files;
}

}  // namespace

void check_outputs(const BakeResult& result) {
    const TransmittanceSettings& settings = result.request.transmittance;
    if (result.hair && result.request.wants("glb"))
        check_glb_size(result.hair->vertex_count(), result.hair->strand_count(), settings.sh_bands, settings.bent_cone);
}

std::vector<WrittenFile> write_files(BakeResult& result, const std::filesystem::path& folder, Progress& progress) {
    const BakeRequest& request = result.request;
    std::vector<WrittenFile> files;
    const auto step = [&](double fraction) {
        progress.check();
        progress.report(fraction);
    };
    if (result.transmittance) append(files, write_transmittance(result, folder, progress));
    step(0.2);
    if (result.irradiance) {
        if (request.wants("npy")) append(files, write_map_npy(*result.irradiance, folder));
        step(0.3);
        if (request.wants("exr")) append(files, write_map_exr(*result.irradiance, folder, progress));
        append(files, write_half_maps(result, folder, progress));
        files.push_back(write_environment_sh(*result.irradiance, folder));
    }
    step(0.6);
    files.push_back(write_preview(result, folder, result.warnings));
    step(0.95);
    return files;
}

}  // namespace hairbake
