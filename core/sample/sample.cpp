#include "core/sample/sample.h"

#include <system_error>
#include <utility>

#include "core/base/error.h"
#include "core/environment/environment_writer.h"
#include "core/hair/hair_format_writer.h"
#include "core/output/file_sink.h"
#include "core/sample/groom_generator.h"
#include "core/sample/head_mesh.h"
#include "core/sample/sky_generator.h"

namespace hairbake {
namespace {

GroomSettings groom_of(const SampleSettings& settings) {
    GroomSettings groom;
    if (settings.paper_model) {
        groom = paper_model(*settings.paper_model);
    } else {
        groom.style = settings.style;
        groom.vertices = settings.vertices;
    }
    groom.seed = settings.seed;
    return groom;
}

constexpr const char* sample_files[] = {"groom.hair", "head.obj", "sky.hdr", "studio.hdr", "overcast.hdr"};

void create_folder(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) throw Error(ErrorKind::bad_input, folder.string() + " cannot be created: " + error.message(), "folder");
}

}  // namespace

std::vector<std::filesystem::path> write_samples(const std::filesystem::path& folder, const SampleSettings& settings,
                                                 Progress& progress) {
    const GroomSettings groom = groom_of(settings);
    create_folder(folder);
    for (const char* name : sample_files) prove_file_writable(folder / name);
    std::vector<std::filesystem::path> files;
    // Each file appears whole, because it is written under another name first. No file is begun after a cancel, so
    // that nothing is left after discard_sample_parts().
    const auto add = [&](const std::string& name, const auto& write, const auto& make) {
        progress.check();
        progress.report(static_cast<double>(files.size()) / 5);
        const auto made = make();
        progress.check();
        write(made, part_of(folder / name));
        std::filesystem::rename(part_of(folder / name), files.emplace_back(folder / name));
    };
    const auto hair = [&](const HairModel& model, const auto& file) {
        write_hair(model, file, make_hair_file_extras(model, description_of(groom)));
    };
    try {
        add("groom.hair", hair, [&] { return generate_groom(groom); });
        add("head.obj", write_obj, [] { return make_head_mesh(); });
        for (const auto& [sky, name] : {std::pair(Sky::sunny, "sky.hdr"), std::pair(Sky::studio, "studio.hdr"),
                                        std::pair(Sky::overcast, "overcast.hdr")})
            add(name, write_environment,
                [&, sky = sky] { return generate_sky(sky, settings.map_width, settings.seed); });
    } catch (...) {
        discard_sample_parts(folder);
        throw;
    }
    progress.report(1);
    return files;
}

void discard_sample_parts(const std::filesystem::path& folder) noexcept {
    try {
        for (const char* name : sample_files) discard_part(folder / name);
    } catch (const std::exception&) {
        // Only memory for the names of the files can be missing. The unfinished files then stay.
    }
}

}  // namespace hairbake
