#include "tests/core/environment/picture_files.h"

#include <OpenImageIO/imageio.h>

namespace hairbake::picture_files {

void write_exr(const std::filesystem::path& file, int w, int h, const std::vector<Vec3f>& pixels,
               const ExrHeader& header) {
    OIIO::ImageSpec spec(w, h, 3, OIIO::TypeDesc::FLOAT);
    spec.x = header.x, spec.y = header.y;
    spec.full_x = header.full_x, spec.full_y = header.full_y;
    spec.full_width = header.full_width.value_or(w), spec.full_height = header.full_height.value_or(h);
    if (header.tiled) spec.tile_width = spec.tile_height = 16;
    if (!header.texture.empty()) spec.attribute("textureformat", header.texture);
    if (header.chromaticities)
        spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), header.chromaticities->data());
    const auto output = OIIO::ImageOutput::create(file.string());
    ASSERT_TRUE(output && output->open(file.string(), spec)) << OIIO::geterror();
    ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, pixels.data())) << output->geterror();
    ASSERT_TRUE(output->close());
}

}  // namespace hairbake::picture_files
