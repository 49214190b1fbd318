#include "core/output/hair_colors.h"

#include <ostream>

#include "core/hair/hair_file.h"
#include "core/output/format_table.h"
#include "core/output/sink_buffer.h"

namespace hairbake {

WrittenFile write_transmittance_hair(const HairModel& model, std::span<const float> average,
                                     const std::filesystem::path& folder) {
    FileSink sink(folder / "transmittance.hair");
    SinkBuffer buffer(sink);
    std::ostream stream(&buffer);
    stream.exceptions(std::ios::badbit);  // makes the stream rethrow what the sink throws
    write_hair(with_transmittance_as_colors(model, average), stream);
    WrittenFile written = sink.finish();
    written.shape = {average.size()};
    written.content = "the model with A as grey vertex colours";
    return written;
}

std::vector<WrittenFile> write_hair_colors(const OutputContext& context, const StagePart& part) {
    const VertexArray* average = find_array(part.arrays, average_transmittance_kind());
    if (!average) return {};
    return {write_transmittance_hair(*context.result.hair, average->values, context.folder)};
}

}  // namespace hairbake
