#include "core/output/transmittance_files.h"

#include <ostream>

#include "core/hair/hair_file.h"
#include "core/output/npy.h"
#include "core/output/sink_buffer.h"

namespace hairbake {
namespace {

WrittenFile write_npy(const std::filesystem::path& file, const std::vector<std::size_t>& shape,
                      std::span<const float> values, const char* content) {
    FileSink sink(file);
    sink.write(npy_header(shape));
    sink.write(npy_data(values));
    WrittenFile written = sink.finish();
    written.shape = shape;
    written.content = content;
    return written;
}

}  // namespace

WrittenFile write_transmittance_npy(std::span<const float> average, const std::filesystem::path& folder) {
    return write_npy(folder / "transmittance.npy", {average.size()}, average,
                     "average transmittance A of every vertex");
}

std::vector<WrittenFile> write_directional_npy(const Transmittance& transmittance, int sh_bands, bool bent_cone,
                                               bool receiver, const std::filesystem::path& folder) {
    const std::size_t vertices = transmittance.average.size(), bands = static_cast<std::size_t>(sh_bands),
                      coefficients = bands * bands;
    std::vector<WrittenFile> files;
    if (sh_bands > 0)
        files.push_back(write_npy(folder / "transmittance_sh.npy", {vertices, coefficients}, transmittance.sh,
                                  "spherical harmonics of every vertex's transmittance, order l*l + l + m, z polar; "
                                  "A = c_0 / (2 sqrt(pi))"));
    if (bent_cone)
        files.push_back(write_npy(folder / "bent_cone.npy", {vertices, 4}, transmittance.bent_cone,
                                  "bent cone of every vertex: unit axis and half-angle in radians; 0, 0, 0, pi where "
                                  "nothing is blocked"));
    if (receiver)
        files.push_back(write_npy(folder / "receiver.npy", {transmittance.receiver.size() / 2, 2},
                                  transmittance.receiver,
                                  "transmittance over the hemisphere about every receiver vertex's normal: mean, and "
                                  "cosine-weighted mean"));
    return files;
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
