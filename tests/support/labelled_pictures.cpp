#include "tests/support/labelled_pictures.h"

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "tests/support/labelled_cube.h"

namespace hairbake {
namespace {

constexpr Vec3d X{1, 0, 0}, Y{0, 1, 0}, Z{0, 0, 1};

// A square of a picture, in units of faces, and the directions of its middle, to its right and down.
struct Square {
    int column, row;
    Vec3d middle, right, down;
};

// Around +Z, right is +X and down is -Y. Each neighbour is turned back by a quarter about the common edge: the
// direction from +Z's middle to that edge is the neighbour's middle, and further in that direction the neighbour goes
// towards -Z.
const std::array<Square, 6> horizontal_cross{
    {{1, 1, Z, X, -Y}, {2, 1, X, -Z, -Y}, {3, 1, -Z, -X, -Y}, {0, 1, -X, Z, -Y}, {1, 0, Y, X, Z}, {1, 2, -Y, X, -Z}}};
const std::array<Square, 6> vertical_cross{
    {{1, 1, Z, X, -Y}, {2, 1, X, -Z, -Y}, {0, 1, -X, Z, -Y}, {1, 0, Y, X, Z}, {1, 2, -Y, X, -Z}, {1, 3, -Z, X, Y}}};
// The faces in their order, upright as OpenGL stores them.
const std::array<Square, 6> faces{
    {{0, 0, X, -Z, -Y}, {1, 0, -X, Z, -Y}, {2, 0, Y, X, Z}, {3, 0, -Y, X, -Z}, {4, 0, Z, X, -Y}, {5, 0, -Z, -X, -Y}}};

void draw(LabelledPicture& picture, const Square& square, int size) {
    for (int row = 0; row < size; ++row)
        for (int column = 0; column < size; ++column) {
            const double a = (2 * column + 1) / double(size) - 1, b = (2 * row + 1) / double(size) - 1;
            const std::size_t pixel =
                std::size_t(square.row * size + row) * picture.width + square.column * size + column;
            picture.pixels[pixel] = labelled_radiance(square.middle + square.right * a + square.down * b);
        }
}

LabelledPicture blank(int width, int height, float value) {
    return {width, height, std::vector<Vec3f>(std::size_t(width) * height, Vec3f(value))};
}

LabelledPicture latlong(int height, const Vec3d& centre, const Vec3d& right) {
    LabelledPicture picture = blank(2 * height, height, 0);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < 2 * height; ++x) {
            const double theta = std::numbers::pi * (y + 0.5) / height,
                         phi = std::numbers::pi * (x + 0.5) / height - std::numbers::pi;
            picture.pixels[std::size_t(y) * 2 * height + x] = labelled_radiance(
                Y * std::cos(theta) + (centre * std::cos(phi) + right * std::sin(phi)) * std::sin(theta));
        }
    return picture;
}

}  // namespace

LabelledPicture labelled_picture(std::string_view layout, int size, float outside) {
    if (layout == "gltf") return latlong(2 * size, X, Z);
    if (layout == "filament") return latlong(2 * size, Z, X);
    if (layout == "openexr") return latlong(2 * size, Z, -X);
    LabelledPicture picture;
    if (layout == "horizontal_cross") {
        picture = blank(4 * size, 3 * size, outside);
        for (const Square& square : horizontal_cross) draw(picture, square, size);
    } else if (layout == "vertical_cross") {
        picture = blank(3 * size, 4 * size, outside);
        for (const Square& square : vertical_cross) draw(picture, square, size);
    } else if (layout == "horizontal_strip") {
        picture = blank(6 * size, size, outside);
        for (const Square& square : faces) draw(picture, square, size);
    } else if (layout == "vertical_strip") {
        picture = blank(size, 6 * size, outside);
        for (const Square& face : faces) draw(picture, {0, face.column, face.middle, face.right, face.down}, size);
    } else {
        throw std::invalid_argument("no such layout: " + std::string(layout));
    }
    return picture;
}

LabelledPicture labelled_face(int face, int size) {
    LabelledPicture picture = blank(size, size, 0);
    const Square& square = faces.at(face);
    draw(picture, {0, 0, square.middle, square.right, square.down}, size);
    return picture;
}

}  // namespace hairbake
