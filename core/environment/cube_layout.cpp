#include "core/environment/cube_layout.h"

#include "core/base/assert.h"

namespace hairbake {
namespace {

using enum EnvironmentLayout;

constexpr std::array<CubeLayout, 4> layouts{{
    {horizontal_cross, 4, 3, {{{2, 1}, {0, 1}, {1, 0}, {1, 2}, {1, 1}, {3, 1}}}},
    {vertical_cross, 3, 4, {{{2, 1}, {0, 1}, {1, 0}, {1, 2}, {1, 1}, {1, 3, true}}}},
    {horizontal_strip, 6, 1, {{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}}}},
    {vertical_strip, 1, 6, {{{0, 0}, {0, 1}, {0, 2}, {0, 3}, {0, 4}, {0, 5}}}},
}};

bool has_shape(const CubeLayout& layout, int width, int height) {
    return width > 0 && width % layout.columns == 0 && height % layout.rows == 0 &&
           width / layout.columns == height / layout.rows;
}

}  // namespace

const CubeLayout* find_cube_layout(EnvironmentLayout wanted) {
    for (const CubeLayout& layout : layouts)
        if (layout.layout == wanted) return &layout;
    return nullptr;
}

std::optional<EnvironmentLayout> layout_of_shape(int width, int height) {
    if (height > 0 && width % 2 == 0 && width / 2 == height) return latlong;
    for (const CubeLayout& layout : layouts)
        if (has_shape(layout, width, height)) return layout.layout;
    return std::nullopt;
}

std::string known_shapes() {
    std::string text = "2:1 (latlong)";
    for (const CubeLayout& layout : layouts)
        text += ", " + std::to_string(layout.columns) + ":" + std::to_string(layout.rows) + " (" +
                std::string(name_of(layout.layout)) + ")";
    return text + ", or six square pictures as a folder or a pattern with {face} (faces)";
}

PicturePixel pixel_of_texel(const CubeLayout& layout, int size, int face, int row, int column) {
    const FacePlace& place = layout.faces.at(face);
    if (place.turned) {
        row = size - 1 - row;
        column = size - 1 - column;
    }
    return {place.column * size + column, place.row * size + row};
}

CubeTexels take_cube(const CubeLayout& layout, int size, std::span<const Vec3f> pixels) {
    const std::size_t width = std::size_t(layout.columns) * size;
    HAIRBAKE_ASSERT(pixels.size() == width * layout.rows * size);
    CubeTexels texels;
    texels.reserve(std::size_t(cube_faces) * size * size);
    for (int face = 0; face < cube_faces; ++face)
        for (int row = 0; row < size; ++row)
            for (int column = 0; column < size; ++column) {
                const PicturePixel p = pixel_of_texel(layout, size, face, row, column);
                texels.push_back(pixels[p.y * width + p.x]);
            }
    return texels;
}

}  // namespace hairbake
