// A hair model: strands of points with their widths, transparencies and colours.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/vec.h"

namespace hairbake {

/// The data of a model that the baking and every output need, whatever the format of its file.
///
/// Strands stand in file order. V = positions.size() is the number of points, S = strand_begin.size() - 1 that of
/// strands. Strand s owns the points [strand_begin[s], strand_begin[s + 1]), root first, at least one each. Positions
/// are finite and in the model's own unit, right-handed, Y up.
///
/// thickness, transparency and colors have one value for each point, or are empty; then the default_ value below holds
/// for every point. Beside an array its default_ value has no meaning.
struct HairModel {
    std::vector<std::uint32_t> strand_begin;  ///< [S + 1]; may be empty where S = 0
    std::vector<Vec3f> positions;             ///< [V]
    std::vector<float> thickness;             ///< [V] or empty; strand diameter in the model's unit
    std::vector<float> transparency;          ///< [V] or empty; 0 opaque .. 1 clear
    std::vector<Vec3f> colors;                ///< [V] or empty; linear RGB

    float default_thickness = 0;  ///< 0: the file gives no width
    float default_transparency = 0;
    Vec3f default_color{1, 1, 1};

    std::string format = "HAIR";  ///< format and version of the file, as people write it: "TressFX 4.0"

    std::size_t strand_count() const { return strand_begin.empty() ? 0 : strand_begin.size() - 1; }
    std::size_t vertex_count() const { return positions.size(); }
};

/// "strand 12, vertex 3" for point `i` of the model, i < V. Both count from 0, the vertex within its strand.
std::string place_of_point(const HairModel& model, std::size_t i);

}  // namespace hairbake
