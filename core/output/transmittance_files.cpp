#include "core/output/transmittance_files.h"

#include <ostream>

#include "core/hair/hair_file.h"
#include "core/output/npy.h"
#include "core/output/sink_buffer.h"

namespace hairbake {

WrittenFile write_transmittance_npy(std::span<const float> average, const std::filesystem::path& folder) {
    FileSink sink(folder / "transmittance.npy");
    const std::vector<std::size_t> shape{average.size()};
    sink.write(npy_header(shape));
    sink.write(npy_data(average));
    WrittenFile written = sink.finish();
    written.shape = shape;
    written.content = "average transmittance A of every vertex";
    return written;
}

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

}  // namespace hairbake
