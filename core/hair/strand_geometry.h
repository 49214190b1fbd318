// The strands as the computations use them: polylines with a width and an opacity at each vertex.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/assert.h"
#include "core/base/vec.h"
#include "core/hair/hair_model.h"
#include "core/hair/strand_settings.h"

namespace hairbake {

/// The kind of the segment from vertex i to i + 1.
enum class Segment : std::uint8_t {
    none,       ///< vertex i is the last of its strand: no segment starts there
    solid,      ///< carries extinction
    degenerate  ///< so short that it carries none; its two ends count as one point of the strand
};

/// Strands as polylines. Segment i joins the vertices i and i + 1 of one strand.
struct StrandGeometry {
    std::vector<std::uint32_t> strand_begin;  ///< [S + 1], as in HairModel
    std::vector<Vec3f> positions;             ///< [V]
    std::vector<float> widths;                ///< [V], diameters > 0 in model units
    std::vector<float> opacities;             ///< [V], in [0, 1]
    std::vector<Segment> segments;            ///< [V]

    std::size_t segment_count = 0;             ///< segments of the model, degenerate ones included
    std::size_t degenerate_segment_count = 0;  ///< those of them that carry no extinction
    Vec3f bounds_min, bounds_max;              ///< of the positions, widths not included

    std::size_t strand_count() const { return strand_begin.size() - 1; }
    std::size_t vertex_count() const { return positions.size(); }
};

/// The segments that touch vertex `v`, with degenerate ones skipped: all solid segments i with first <= i <= last. The
/// transmittance at `v` leaves these out.
struct AdjacentSegments {
    std::uint32_t first, last;
    bool contains(std::uint32_t segment) const { return segment >= first && segment <= last; }
};

inline AdjacentSegments adjacent_segments(const StrandGeometry& strands, std::uint32_t v) {
    HAIRBAKE_ASSERT(v < strands.vertex_count());
    std::uint32_t first = v, last = v;
    while (first > 0 && strands.segments[first - 1] == Segment::degenerate) --first;
    if (first > 0 && strands.segments[first - 1] == Segment::solid) --first;
    while (strands.segments[last] == Segment::degenerate) ++last;
    return {first, last};
}

/// Applies `settings` to `model`. A segment is degenerate when its length is zero or below 1e-6 of the longest side
/// of the bounds.
/// Throws Error(bad_input) naming strand and vertex:
/// - for a width that is not positive and finite (the message asks for strand.width), or an opacity outside [0, 1];
/// - for the point farthest out, where more than half of the segments with a length are degenerate and half of the
///   points lie within 1 % of the bounds' longest side from the middle.
StrandGeometry make_strand_geometry(const HairModel& model, const StrandSettings& settings);

}  // namespace hairbake
