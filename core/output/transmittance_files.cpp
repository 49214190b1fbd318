#include "core/output/transmittance_files.h"

#include <ostream>
#include <streambuf>

#include "core/hair/hair_file.h"
#include "core/output/npy.h"

namespace hairbake {
namespace {

/// Lets a writer of streams write into a FileSink. Errors of the sink pass through the stream as exceptions.
class SinkBuffer : public std::streambuf {
public:
    explicit SinkBuffer(FileSink& sink) : sink_(sink) {}

protected:
    std::streamsize xsputn(const char* bytes, std::streamsize count) override {
        sink_.write(std::string_view(bytes, static_cast<std::size_t>(count)));
        return count;
    }
    int_type overflow(int_type c) override {
        const char byte = traits_type::to_char_type(c);
        xsputn(&byte, 1);
        return c;
    }

private:
    FileSink& sink_;
};

}  // namespace

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
