// Lets a library that writes to a stream write into a FileSink.
#pragma once

#include <ostream>
#include <streambuf>

#include "core/output/file_sink.h"

namespace hairbake {

/// The buffer of a stream whose bytes go to a sink. Errors of the sink pass through the stream as exceptions where the
/// stream's exceptions are enabled: stream.exceptions(std::ios::badbit).
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

}  // namespace hairbake
