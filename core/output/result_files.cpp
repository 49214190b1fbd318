#include "core/output/result_files.h"

#include <iterator>

#include "core/output/map_files.h"
#include "core/output/preview.h"
#include "core/output/transmittance_files.h"

namespace hairbake {
namespace {

void append(std::vector<WrittenFile>& files, std::vector<WrittenFile> more) {
    files.insert(files.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

}  // namespace

std::vector<WrittenFile> write_files(BakeResult& result, const std::filesystem::path& folder, Progress& progress) {
    const BakeRequest& request = result.request;
    std::vector<WrittenFile> files;
    const auto step = [&](double fraction) {
        progress.check();
        progress.report("write", fraction);
    };
    if (result.transmittance) {
        const std::vector<float>& average = result.transmittance->average;
        if (request.wants("npy")) {
            const TransmittanceSettings& settings = request.transmittance;
            files.push_back(write_transmittance_npy(average, folder));
            append(files, write_directional_npy(*result.transmittance, settings.sh_bands, settings.bent_cone,
                                                request.receiver.has_value(), folder));
        }
        if (request.wants("hair")) files.push_back(write_transmittance_hair(*result.hair, average, folder));
    }
    step(0.2);
    if (result.irradiance) {
        if (request.wants("npy")) append(files, write_map_npy(*result.irradiance, folder));
        step(0.3);
        if (request.wants("exr")) append(files, write_map_exr(*result.irradiance, folder, progress));
        files.push_back(write_environment_sh(*result.irradiance, folder));
    }
    step(0.6);
    files.push_back(write_preview(result, folder, result.warnings));
    step(0.95);
    return files;
}

}  // namespace hairbake
