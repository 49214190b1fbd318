// Draws the pictures of docs/formats.md: labelled_cube_pictures FOLDER.
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>

#include "tests/support/labelled_pictures.h"

namespace {

// One stop darker, so that the white names stand out from the light faces.
std::uint8_t srgb(float linear) {
    const float v = std::clamp(linear / 2, 0.0f, 1.0f);
    return static_cast<std::uint8_t>(
        std::lround(255 * (v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f)));
}

bool save(const hairbake::LabelledPicture& picture, const std::filesystem::path& file) {
    std::vector<std::uint8_t> bytes;
    for (const hairbake::Vec3f& p : picture.pixels)
        for (int c = 0; c < 3; ++c) bytes.push_back(srgb(p[c]));
    const auto output = OIIO::ImageOutput::create("png");
    OIIO::ImageSpec spec(picture.width, picture.height, 3, OIIO::TypeDesc::UINT8);
    spec.attribute("png:compressionLevel", 9);
    return output && output->open(file.string(), spec) && output->write_image(OIIO::TypeDesc::UINT8, bytes.data()) &&
           output->close();
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: %s FOLDER\n", argv[0]);
        return 2;
    }
    constexpr int face_size = 44;  // twice the 22 cells of the labels
    for (const char* layout :
         {"gltf", "filament", "openexr", "horizontal_cross", "vertical_cross", "horizontal_strip", "vertical_strip"}) {
        const std::filesystem::path file = std::filesystem::path(argv[1]) / ("layout_" + std::string(layout) + ".png");
        if (!save(hairbake::labelled_picture(layout, face_size), file)) {
            std::fprintf(stderr, "%s: cannot be written: %s\n", file.c_str(), OIIO::geterror().c_str());
            return 1;
        }
    }
    return 0;
}
