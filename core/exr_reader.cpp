#include "core/exr_reader.h"

#include <OpenImageIO/imageio.h>

#include <filesystem>
#include <memory>
#include <new>
#include <string>

#include "core/base/error.h"

namespace hairbake {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& what) {
    throw Error(ErrorKind::bad_input, file.string() + " " + what);
}

void check(const OIIO::ImageSpec& spec, const std::filesystem::path& file) {
    constexpr int most = 16384, most_channels = 64;
    if (spec.width < 1 || spec.height < 1 || spec.width > most || spec.height > most)
        refuse(file, "is " + std::to_string(spec.width) + " x " + std::to_string(spec.height) +
                         " pixels; allowed are 1 to 16384 each");
    if (spec.nchannels < 3 || spec.nchannels > most_channels)
        refuse(file, "has " + std::to_string(spec.nchannels) + " channels; allowed are 3 to 64");
    if (spec.deep || spec.depth > 1) refuse(file, "is volumetric or deep; allowed is a flat picture");
    if (spec.x != spec.full_x || spec.y != spec.full_y || spec.width != spec.full_width ||
        spec.height != spec.full_height)
        refuse(file, "does not fill its display window");
}

}  // namespace

ExrPicture read_exr(const std::filesystem::path& file) try {
    if (!std::filesystem::is_regular_file(file)) refuse(file, "is no file");
    const auto input = OIIO::ImageInput::create("openexr");
    if (!input) throw Error(ErrorKind::internal, "OpenImageIO has no reader for OpenEXR");
    OIIO::ImageSpec spec;
    if (!input->open(file.string(), spec)) refuse(file, "is no readable OpenEXR picture: " + input->geterror());
    check(spec, file);
    ExrPicture picture{spec.width, spec.height, {}};
    picture.pixels.resize(static_cast<std::size_t>(spec.width) * spec.height);
    if (!input->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, picture.pixels.data()) || input->has_error())
        refuse(file, "cannot be decoded: " + input->geterror());
    return picture;
} catch (const std::bad_alloc&) {
    throw Error(ErrorKind::out_of_resources, file.string() + ": not enough memory for the picture");
}

}  // namespace hairbake
