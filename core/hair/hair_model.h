// A hair model as its file gave it: strands of points, with whatever arrays the file has.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/vec.h"

namespace hairbake {

/// Strands in file order. V = positions.size() points, S = strand_begin.size() - 1 strands; strand s owns the points
/// [strand_begin[s], strand_begin[s+1]), root first, at least one point each. An optional array is empty when the file
/// has none, and then the default of the header holds for every point. Everything is kept that a writer needs to give
/// the file back unchanged. Positions are finite and in the model's own unit, right-handed, Y up.
struct HairModel {
    std::vector<std::uint32_t> strand_begin;  ///< [S + 1]
    std::vector<Vec3f> positions;             ///< [V]
    std::vector<float> thickness;             ///< [V] or empty; strand diameter
    std::vector<float> transparency;          ///< [V] or empty; 0 opaque .. 1 clear
    std::vector<Vec3f> colors;                ///< [V] or empty; linear RGB

    std::string format = "HAIR";  ///< of the file: "HAIR", "TressFX 3.0" or "TressFX 4.0"

    bool has_segments_array = true;  ///< whether the file gives a segment count for each strand
    std::uint32_t default_segments = 0;
    float default_thickness = 0;
    float default_transparency = 0;
    Vec3f default_color{1, 1, 1};
    std::array<char, 88> info{};     ///< the header's free text, as in the file
    std::uint32_t empty_arrays = 0;  ///< V = 0 only: array bits of the file, whose arrays then have no entries

    std::size_t strand_count() const { return strand_begin.empty() ? 0 : strand_begin.size() - 1; }
    std::size_t vertex_count() const { return positions.size(); }
};

/// "strand 12, vertex 3" for point `i` of the model, both counted from 0, the vertex within its strand.
std::string place_of_point(const HairModel& model, std::size_t i);

}  // namespace hairbake
