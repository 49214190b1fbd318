#include "core/sample.h"

#include <system_error>
#include <utility>

#include "core/base/error.h"
#include "core/environment/environment_writer.h"
#include "core/environment/sky_generator.h"
#include "core/hair/groom_generator.h"
#include "core/hair/hair_file.h"
#include "core/hair/head_mesh.h"

namespace hairbake {
namespace {

GroomStyle style_named(const std::string& name) {
    if (name == "straight") return GroomStyle::straight;
    if (name == "wavy") return GroomStyle::wavy;
    if (name == "curly") return GroomStyle::curly;
    throw Error(ErrorKind::usage, "style is \"" + name + "\"; allowed is one of straight, wavy, curly", "style");
}

GroomSettings groom_of(const SampleSettings& settings) {
    GroomSettings groom;
    if (settings.paper_model) {
        groom = paper_model(*settings.paper_model);
    } else {
        groom.style = style_named(settings.style);
        groom.vertices = settings.vertices;
    }
    groom.seed = settings.seed;
    return groom;
}

void make_folder(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) throw Error(ErrorKind::bad_input, folder.string() + " cannot be made: " + error.message(), "folder");
}

}  // namespace

std::vector<std::filesystem::path> write_samples(const std::filesystem::path& folder, const SampleSettings& settings,
                                                 Progress& progress) {
    const GroomSettings groom = groom_of(settings);
    make_folder(folder);
    std::vector<std::filesystem::path> files;
    // Each file appears whole: it is written under another name first.
    const auto add = [&](const std::string& name, const auto& write) {
        progress.check();
        progress.report("write", static_cast<double>(files.size()) / 5);
        const std::filesystem::path part = folder / (".part-" + name);
        write(part);
        std::filesystem::rename(part, files.emplace_back(folder / name));
    };
    add("groom.hair", [&](const auto& file) { write_hair(generate_groom(groom), file); });
    add("head.obj", [&](const auto& file) { write_obj(make_head_mesh(), file); });
    for (const auto& [sky, name] : {std::pair(Sky::sunny, "sky.hdr"), std::pair(Sky::studio, "studio.hdr"),
                                    std::pair(Sky::overcast, "overcast.hdr")})
        add(name, [&, sky = sky](const auto& file) {
            write_environment(generate_sky(sky, settings.map_width, settings.seed), file);
        });
    progress.report("write", 1);
    return files;
}

}  // namespace hairbake
