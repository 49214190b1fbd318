#include "core/environment/environment_writer.h"

#include <OpenImageIO/imageio.h>

#include "core/base/error.h"

namespace hairbake {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& reason) {
    std::error_code ignored;
    std::filesystem::remove(file, ignored);
    throw Error(ErrorKind::out_of_resources, file.string() + ": could not be written: " + reason);
}

}  // namespace

void write_environment(const EnvironmentMap& map, const std::filesystem::path& file) {
    const std::string ending = file.extension().string();
    if (ending != ".hdr" && ending != ".exr")
        throw Error(ErrorKind::usage, file.string() + ": the ending is \"" + ending + "\"; allowed are .hdr and .exr");
    const auto output = OIIO::ImageOutput::create(ending == ".hdr" ? "hdr" : "openexr");
    if (!output) fail(file, OIIO::geterror());
    OIIO::ImageSpec spec(map.width, map.height, 3, OIIO::TypeDesc::FLOAT);
    if (ending == ".exr") {
        spec.attribute("compression", "zip");
        spec.attribute("hairbake:latlong", std::string(name_of(map.latlong)));
    }
    if (!output->open(file.string(), spec)) fail(file, output->geterror());
    if (!output->write_image(OIIO::TypeDesc::FLOAT, map.pixels.data())) fail(file, output->geterror());
    if (!output->close()) fail(file, output->geterror());
}

}  // namespace hairbake
