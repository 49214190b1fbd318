// What the physics sees of a hair model: polylines with a width and an opacity at each vertex.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/vec.h"
#include "core/hair/hair_model.h"

namespace hairbake {

/// A strand segment joins vertex i and i + 1 of the same strand. `segment_ok[i]` says whether vertex i starts a
/// segment that carries extinction: false for the last vertex of a strand and for zero-length or
/// near-degenerate segments.
struct StrandGeometry {
    std::vector<std::uint32_t> strand_begin;  ///< [S + 1], as in HairModel
    std::vector<Vec3f> positions;             ///< [V]
    std::vector<float> widths;                ///< [V], diameters > 0 in model units
    std::vector<float> opacities;             ///< [V], in [0, 1]
    std::vector<std::uint8_t> segment_ok;     ///< [V]

    std::size_t segment_count = 0;             ///< segments of the model, degenerate ones included
    std::size_t degenerate_segment_count = 0;  ///< those of them that carry no extinction
    Vec3f bounds_min, bounds_max;              ///< of the positions, widths not included

    std::size_t strand_count() const { return strand_begin.size() - 1; }
    std::size_t vertex_count() const { return positions.size(); }
};

/// Applies `settings` to `model`. A segment is degenerate when its length is zero or below 1e-6 of the longest side
/// of the bounds.
/// Throws Error(bad_input) naming strand and vertex for a width that is not positive and finite (the message
/// tells to give strand.width) or an opacity outside [0, 1].
StrandGeometry make_strand_geometry(const HairModel& model, const StrandSettings& settings);

}  // namespace hairbake
