#include "tests/support/labelled_cube.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace hairbake {
namespace {

constexpr int glyph_width = 5, glyph_height = 7, cells = 22;  // of the font, and across a face

using Glyph = std::array<std::string_view, glyph_height>;

Glyph glyph_of(char letter) {
    switch (letter) {
        case '+':
            return {".....", "..#..", "..#..", "#####", "..#..", "..#..", "....."};
        case '-':
            return {".....", ".....", ".....", "#####", ".....", ".....", "....."};
        case 'X':
            return {"#...#", "#...#", ".#.#.", "..#..", ".#.#.", "#...#", "#...#"};
        case 'Y':
            return {"#...#", "#...#", ".#.#.", "..#..", "..#..", "..#..", "..#.."};
        default:
            return {"#####", "....#", "...#.", "..#..", ".#...", "#....", "#####"};
    }
}

// Cells from the text's upper left corner; it is 11 cells wide and begins 5.5 left of the centre, 3.5 above it.
bool in_name(const CubePoint& p) {
    const double x = p.a * cells / 2 + 5.5, y = p.b * cells / 2 + 3.5;
    if (x < 0 || y < 0 || x >= 2 * glyph_width + 1 || y >= glyph_height) return false;
    const int column = static_cast<int>(x), row = static_cast<int>(y);
    if (column == glyph_width) return false;
    const bool second = column > glyph_width;
    return glyph_of(cube_face_name(p.face)[second])[row][second ? column - glyph_width - 1 : column] == '#';
}

bool in_arrow(const CubePoint& p) { return p.b > -0.7 && p.b < -0.4 && std::abs(p.a) < (p.b + 0.7) / 2; }

float level(double component) { return component > 0.75 ? 1 : component < -0.75 ? 1 / 16.0f : 0.5f; }

}  // namespace

Vec3f labelled_colour(const Vec3d& d) {
    const double largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    return {level(d.x / largest), level(d.y / largest), level(d.z / largest)};
}

Vec3f labelled_radiance(const Vec3d& direction) {
    const CubePoint p = cube_point(direction);
    if (in_name(p)) return {4, 4, 4};
    if (in_arrow(p)) return {0, 0, 0};
    return labelled_colour(direction);
}

std::vector<Vec3d> labelled_directions() {
    std::vector<Vec3d> directions;
    for (int axis = 0; axis < 3; ++axis)
        for (const double sign : {1.0, -1.0})
            for (const double u : {-0.9, 0.0, 0.9})
                for (const double v : {-0.9, 0.0, 0.9}) {
                    Vec3d d;
                    d[axis] = sign;
                    d[(axis + 1) % 3] = u;
                    d[(axis + 2) % 3] = v;
                    directions.push_back(d);
                }
    return directions;
}

Vec3f texel_towards(const EnvironmentMap& map, const Vec3d& direction) {
    const MapPoint p = point_of(map, direction);
    const int x = std::min(int(p.x), map.width - 1), y = std::min(int(p.y), map.height - 1);
    return map.pixels[std::size_t(y) * map.width + x];
}

CubeTexels labelled_cube(int face_size) {
    CubeTexels texels;
    texels.reserve(std::size_t(cube_faces) * face_size * face_size);
    for (int face = 0; face < cube_faces; ++face)
        for (int row = 0; row < face_size; ++row)
            for (int column = 0; column < face_size; ++column)
                texels.push_back(labelled_radiance(cube_texel_direction(face_size, face, row, column)));
    return texels;
}

}  // namespace hairbake
