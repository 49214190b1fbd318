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

/// The indices of all vertices, ascending.
std::vector<std::uint32_t> all_vertices(const StrandGeometry& strands);

/// The segments of a vertex's own strand that do not shadow it: all solid segments i with first <= i <= last.
struct OwnSegments {
    std::uint32_t first, last;
    bool contains(std::uint32_t segment) const { return segment >= first && segment <= last; }
};

/// How far along its strand a vertex is not shadowed by it, in widths at the vertex. Within this arc length a strand is
/// near itself only by its own thickness: the smallest curls of hair go round in some sixty widths. A ray that leaves
/// the vertex at the angle a to the strand has left the strand after 1 / (2 sin a) widths, so that beyond 8 widths only
/// rays within 3.6 degrees of the strand (0.2 % of the sphere) are still inside; own_strand.h follows those.
inline constexpr float own_arc_widths = 8;

/// The segments that touch vertex `v`, and those with a part within own_arc_widths of it along the strand. Degenerate
/// segments have no length.
OwnSegments own_segments(const StrandGeometry& strands, std::uint32_t v);

/// A strand may end in a point: where the file's width is 0, the vertex has this share of its strand's largest width. So
/// every width is above 0, and the shadow of a tapered segment is wrong by at most a thousandth of the strand's.
inline constexpr float least_width = 1e-3f;

/// Applies `settings` to `model`. A segment is degenerate when its length is zero or below 1e-6 of the longest side
/// of the bounds.
/// Throws Error(bad_input) naming strand and vertex:
/// - for a width that is negative or not finite, a strand without any width above 0 (the message asks for
///   strand.width), or an opacity outside [0, 1];
/// - for the point farthest out, where more than half of the segments with a length are degenerate and half of the
///   points lie within 1 % of the bounds' longest side from the middle.
StrandGeometry make_strand_geometry(const HairModel& model, const StrandSettings& settings);

}  // namespace hairbake
