#include "core/hair/strand_geometry.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>
#include <string>

#include "core/base/bounds.h"
#include "core/base/error.h"
#include "core/base/short_number.h"

namespace hairbake {
namespace {

[[noreturn]] void refuse_width(const std::string& place, const std::string& found) {
    throw Error(ErrorKind::bad_input,
                "the strand width at " + place + " is " + found +
                    "; it must be positive and finite (0 where a strand ends in a point): give strand.width (--width), "
                    "the strand's diameter in the model's unit",
                "strand.width");
}

/// Gives the vertices of width 0 a small one. Throws where a strand has no other.
void fill_tapers(const HairModel& model, std::vector<float>& widths) {
    for (std::size_t s = 0; s < model.strand_count(); ++s) {
        const auto first = widths.begin() + model.strand_begin[s], end = widths.begin() + model.strand_begin[s + 1];
        if (std::find(first, end, 0.0f) == end) continue;
        const float least = least_width * *std::max_element(first, end);
        if (!(least > 0)) refuse_width("all vertices of strand " + std::to_string(s), "0");
        std::replace(first, end, 0.0f, least);
    }
}

std::vector<float> resolve_widths(const HairModel& model, const StrandSettings& settings) {
    std::vector<float> widths(model.vertex_count());
    bool any_zero = false;
    for (std::size_t i = 0; i < widths.size(); ++i) {
        const double from_file = model.thickness.empty() ? model.default_thickness : model.thickness[i];
        const double width = settings.width.value_or(from_file) * settings.width_scale;
        widths[i] = static_cast<float>(width);
        const bool tapered = width == 0 && !settings.width && !model.thickness.empty();
        any_zero = any_zero || tapered;
        if (!tapered && (!(widths[i] > 0) || !std::isfinite(widths[i])))
            refuse_width(place_of_point(model, i), short_number(width));
    }
    if (any_zero) fill_tapers(model, widths);
    return widths;
}

std::vector<float> resolve_opacities(const HairModel& model, const StrandSettings& settings) {
    std::vector<float> opacities(model.vertex_count(), static_cast<float>(settings.opacity));
    if (!settings.opacity_from_file) return opacities;
    for (std::size_t i = 0; i < opacities.size(); ++i) {
        opacities[i] = 1 - (model.transparency.empty() ? model.default_transparency : model.transparency[i]);
        if (!(opacities[i] >= 0 && opacities[i] <= 1))
            throw Error(ErrorKind::bad_input,
                        "the transparency at " + place_of_point(model, i) + " is " + std::to_string(1 - opacities[i]) +
                            "; allowed is 0 to 1 when strand.opacity is from_file",
                        "strand.opacity");
    }
    return opacities;
}

double longest_side(const StrandGeometry& geometry) {
    const Vec3f side = geometry.bounds_max - geometry.bounds_min;
    return std::max({side.x, side.y, side.z});
}

/// Counts of the segments whose length is not 0.
struct SegmentCounts {
    std::size_t with_length = 0, too_short = 0;
};

/// Sets the segments of `geometry` and their counts.
SegmentCounts set_segments(StrandGeometry& geometry) {
    const double shortest = 1e-6 * longest_side(geometry);
    SegmentCounts counts;
    geometry.segments.assign(geometry.vertex_count(), Segment::none);
    for (std::size_t s = 0; s < geometry.strand_count(); ++s)
        for (std::uint32_t i = geometry.strand_begin[s]; i + 1 < geometry.strand_begin[s + 1]; ++i) {
            const double segment_length = length(Vec3d(geometry.positions[i + 1]) - Vec3d(geometry.positions[i]));
            const bool solid = segment_length > 0 && segment_length >= shortest;
            geometry.segments[i] = solid ? Segment::solid : Segment::degenerate;
            ++geometry.segment_count;
            geometry.degenerate_segment_count += !solid;
            counts.with_length += segment_length > 0;
            counts.too_short += segment_length > 0 && !solid;
        }
    return counts;
}

/// The median of each coordinate.
Vec3f median_position(std::vector<Vec3f> positions) {
    Vec3f median;
    const auto middle = positions.begin() + static_cast<std::ptrdiff_t>(positions.size() / 2);
    for (int axis = 0; axis < 3; ++axis) {
        std::nth_element(positions.begin(), middle, positions.end(),
                         [axis](const Vec3f& a, const Vec3f& b) { return a[axis] < b[axis]; });
        median[axis] = (*middle)[axis];
    }
    return median;
}

/// One point far out makes the bounds so large that the strands themselves count as degenerate. A would silently be 1,
/// and the traced reference would agree. A point counts as far out where half of all points lie within a hundredth of
/// the longest side. Otherwise the segments themselves are short, as where every point is duplicated.
void check_for_stray_point(const HairModel& model, const StrandGeometry& geometry, const SegmentCounts& counts) {
    const Vec3d median(median_position(model.positions));
    const auto distance = [&](const Vec3f& p) { return length(Vec3d(p) - median); };
    const double near = 0.01 * longest_side(geometry);
    const auto nearby = std::count_if(model.positions.begin(), model.positions.end(),
                                      [&](const Vec3f& p) { return distance(p) < near; });
    if (2 * static_cast<std::size_t>(nearby) < model.positions.size()) return;
    const auto farthest = std::max_element(model.positions.begin(), model.positions.end(),
                                           [&](const Vec3f& a, const Vec3f& b) { return distance(a) < distance(b); });
    std::ostringstream text;
    text << place_of_point(model, static_cast<std::size_t>(farthest - model.positions.begin())) << " lies "
         << distance(*farthest) << " units from the middle of the model, which makes " << counts.too_short << " of "
         << counts.with_length << " segments shorter than 1e-6 of the model's longest side; allowed is half of them";
    throw Error(ErrorKind::bad_input, text.str());
}

}  // namespace

std::vector<std::uint32_t> all_vertices(const StrandGeometry& strands) {
    std::vector<std::uint32_t> vertices(strands.vertex_count());
    std::iota(vertices.begin(), vertices.end(), 0u);
    return vertices;
}

OwnSegments own_segments(const StrandGeometry& strands, std::uint32_t v) {
    HAIRBAKE_ASSERT(v < strands.vertex_count());
    const float reach = own_arc_widths * strands.widths[v];
    const auto solid_length = [&](std::uint32_t i) {
        if (strands.segments[i] != Segment::solid) return 0.0f;
        return length(strands.positions[i + 1] - strands.positions[i]);
    };
    OwnSegments own{v, v};
    for (float arc = 0; own.first > 0 && strands.segments[own.first - 1] != Segment::none && arc <= reach;)
        arc += solid_length(--own.first);
    float arc = solid_length(v);
    while (strands.segments[own.last] != Segment::none && arc <= reach) {
        if (strands.segments[own.last + 1] == Segment::none) break;
        arc += solid_length(++own.last);
    }
    return own;
}

StrandGeometry make_strand_geometry(const HairModel& model, const StrandSettings& settings) {
    StrandGeometry geometry;
    geometry.widths = resolve_widths(model, settings);
    geometry.opacities = resolve_opacities(model, settings);
    geometry.strand_begin = model.strand_begin;
    if (geometry.strand_begin.empty()) geometry.strand_begin.push_back(0);
    geometry.positions = model.positions;
    const Bounds bounds = bounds_of(geometry.positions);
    geometry.bounds_min = bounds.low;
    geometry.bounds_max = bounds.high;
    const SegmentCounts counts = set_segments(geometry);
    if (counts.too_short > counts.with_length / 2) check_for_stray_point(model, geometry, counts);
    return geometry;
}

}  // namespace hairbake
