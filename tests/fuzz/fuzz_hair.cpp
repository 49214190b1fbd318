// Any bytes as a HAIR file: they are refused as bad input, or read, made into strands and written back unchanged.
#include <cstdint>
#include <sstream>
#include <string_view>

#include "core/base/error.h"
#include "core/hair/hair_file.h"
#include "core/hair/hair_format_writer.h"
#include "core/hair/strand_geometry.h"
#include "tests/fuzz/demand.h"

namespace {

using namespace hairbake;

/// `body` succeeds, or fails as bad input and nothing else.
template <class Body>
bool succeeds_or_refuses(const Body& body) {
    try {
        body();
        return true;
    } catch (const Error& error) {
        demand(error.kind() == ErrorKind::bad_input, "an input's fault is bad_input");
        demand(error.what()[0] != 0, "a refusal has a message");
        return false;
    }
}

void check_geometry(const HairModel& model, const StrandSettings& settings) {
    const StrandGeometry strands = make_strand_geometry(model, settings);
    const std::size_t v = model.vertex_count();
    demand(strands.strand_count() == model.strand_count() && strands.vertex_count() == v, "counts are kept");
    demand(strands.widths.size() == v && strands.opacities.size() == v && strands.segments.size() == v,
           "one value a vertex");
    demand(strands.segment_count == v - model.strand_count(), "a strand of n points has n - 1 segments");
    std::size_t solid = 0;
    for (std::size_t i = 0; i < v; ++i) {
        demand(strands.widths[i] > 0, "widths are positive");
        demand(strands.opacities[i] >= 0 && strands.opacities[i] <= 1, "opacities lie in [0, 1]");
        solid += strands.segments[i] == Segment::solid;
    }
    demand(solid + strands.degenerate_segment_count == strands.segment_count, "every segment is counted once");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Groom groom;
    const auto bytes = std::as_bytes(std::span(data, size));
    if (!succeeds_or_refuses([&] { groom = read_groom(bytes, "fuzz.hair"); })) return 0;
    const HairModel& model = groom.model;
    if (model.format != "HAIR") return 0;  // other formats have fuzz targets of their own

    std::ostringstream written;
    write_hair(model, written, groom.extras);
    demand(written.view() == std::string_view(reinterpret_cast<const char*>(data), size),
           "a model that was read unchanged is written as the same bytes");

    succeeds_or_refuses([&] { check_geometry(model, {}); });
    StrandSettings settings;
    settings.width = 0.01;
    try {
        check_geometry(model, settings);
    } catch (const Error& error) {
        demand(std::string_view(error.what()).find(" segments shorter than ") != std::string_view::npos,
               "with a width, nothing but a stray point is refused");
    }
    settings.opacity_from_file = true;
    succeeds_or_refuses([&] { check_geometry(model, settings); });

    const std::vector<float> transmittance(model.vertex_count(), 0.5f);
    std::ostringstream baked;
    write_hair(with_transmittance_as_colors(model, transmittance), baked, groom.extras);
    const HairModel again = read_hair(std::as_bytes(std::span(baked.view())), "baked.hair");
    demand(again.strand_begin == model.strand_begin && again.colors.size() == model.vertex_count(),
           "grey colours change nothing else");
    return 0;
}
