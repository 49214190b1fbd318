// Any bytes as a TressFX file: they are refused as bad input, or read, made into strands and written as HAIR.
#include <cstdint>
#include <sstream>

#include "core/base/error.h"
#include "core/base/naming_file.h"
#include "core/hair/hair_file.h"
#include "core/hair/hair_format_writer.h"
#include "core/hair/strand_geometry.h"
#include "tests/fuzz/demand.h"

namespace {

using namespace hairbake;

void check_groom(const Groom& groom, std::size_t file_size) {
    const HairModel& model = groom.model;
    const std::size_t v = model.vertex_count();
    demand(v <= file_size / 12, "no more points than the file has bytes for");
    demand(model.strand_begin.front() == 0 && model.strand_begin.back() == v, "the strands cover the points");
    demand(model.colors.empty() || model.colors.size() == v, "a colour for each point or none");
    for (const Vec3f& p : model.positions) demand(is_finite(p), "positions are finite");

    std::ostringstream written;
    write_hair(model, written, groom.extras);
    const Groom again = read_groom(std::as_bytes(std::span(written.view())), "written.hair");
    demand(again.model.positions == model.positions && again.model.strand_begin == model.strand_begin &&
               again.model.colors == model.colors && again.description == groom.description,
           "the HAIR form holds the same model");

    StrandSettings settings;
    settings.width = 0.01;
    const auto strands = naming_file("fuzz.tfx", [&] { return make_strand_geometry(model, settings); });
    demand(strands.segment_count == v - model.strand_count(), "a strand of n points has n - 1 segments");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    // Because of the name, only a HAIR file goes to another reader.
    try {
        check_groom(read_groom(std::as_bytes(std::span(data, size)), "fuzz.tfx"), size);
    } catch (const Error& error) {
        demand(error.kind() == ErrorKind::bad_input, "an input's fault is bad_input");
        demand(std::string_view(error.what()).starts_with("fuzz.tfx: "), "a refusal names the file");
    }
    return 0;
}
