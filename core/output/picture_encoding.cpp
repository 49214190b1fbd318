#include "core/output/picture_encoding.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "core/base/error.h"

namespace hairbake {
namespace {

std::vector<std::byte> encode(const char* format, OIIO::ImageSpec spec, const OIIO::TypeDesc& type, const void* pixels,
                              const Metadata& metadata) {
    for (const auto& [name, value] : metadata) spec.attribute(name, value);
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    const std::string name = std::string("memory.") + format;
    const auto output = OIIO::ImageOutput::create(name, &memory);
    if (!output) throw Error(ErrorKind::internal, "OpenImageIO cannot write " + name + ": " + OIIO::geterror());
    output->threads(1);
    if (!output->open(name, spec) || !output->write_image(type, pixels) || !output->close())
        throw Error(ErrorKind::internal, "OpenImageIO cannot write " + name + ": " + output->geterror());
    const auto* begin = reinterpret_cast<const std::byte*>(bytes.data());
    return {begin, begin + bytes.size()};
}

}  // namespace

std::vector<std::byte> encode_exr(const std::vector<Vec3f>& pixels, int width, int height, const Metadata& metadata,
                                  const std::optional<Chromaticities>& primaries) {
    OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::FLOAT);
    spec.attribute("compression", "zip");
    spec.attribute("DateTime", "");  // or OpenImageIO writes the time of day
    spec.attribute("oiio:ColorSpace", "Linear");
    if (primaries) spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), primaries->data());
    return encode("exr", spec, OIIO::TypeDesc::FLOAT, pixels.data(), metadata);
}

std::vector<std::byte> encode_png(const std::vector<std::uint8_t>& rgb, int width, int height,
                                  const Metadata& metadata) {
    OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    return encode("png", spec, OIIO::TypeDesc::UINT8, rgb.data(), metadata);
}

}  // namespace hairbake
