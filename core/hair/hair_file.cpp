#include "core/hair/hair_file.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <new>
#include <sstream>
#include <system_error>

#include "core/base/error.h"
#include "core/hair/hair_reader.h"

namespace hairbake {
namespace {

/// `error` is errno, or 0 where the system did not tell.
[[noreturn]] void refuse_unreadable(const std::string& name, const std::string& what, int error) {
    const int known = error != 0 ? error : EIO;
    throw Error(ErrorKind::bad_input, name + ": " + what + std::generic_category().message(known), {}, known);
}

/// The reader that recognises the first bytes; null where none does.
const HairReader* reader_of_bytes(std::span<const std::byte> first) {
    for (const HairReader* reader : hair_readers())
        if (reader->recognises(first)) return reader;
    return nullptr;
}

/// The reader whose extension the file's name has, in upper or lower case; null where there is none.
const HairReader* reader_of_name(const std::string& name) {
    std::string extension = std::filesystem::path(name).extension().string();
    for (char& c : extension)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    for (const HairReader* reader : hair_readers())
        if (reader->extension == extension) return reader;
    return nullptr;
}

std::string time_warning(const HairReader& reader, double time) {
    std::ostringstream text;
    text << "strand.time is " << time << " seconds; it has no effect: a file of the format " << reader.name
         << " holds no animation";
    return text.str();
}

/// The reader of this file.
const HairReader& reader_of(const HairSource& source) {
    std::array<std::byte, recognition_bytes> bytes{};
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(source.size, bytes.size()));
    source.copy(0, bytes.data(), count);
    const HairReader* reader = reader_of_bytes(std::span(bytes).first(count));
    if (!reader) reader = reader_of_name(source.name);
    if (!reader) refuse_beginning(source);
    return *reader;
}

Groom read(const HairSource& source, const HairReadSettings& settings) {
    const HairReader& reader = reader_of(source);
    Groom groom = reader.read(source, settings);
    if (settings.time != 0 && !reader.animated) groom.warnings.push_back(time_warning(reader, settings.time));
    return groom;
}

/// Opens the file and calls `body` with its bytes.
template <class Body>
auto with_file(const std::filesystem::path& file, const Body& body) {
    const std::string name = file.string();
    std::error_code problem;
    const auto status = std::filesystem::status(file, problem);
    if (status.type() == std::filesystem::file_type::none)
        refuse_unreadable(name, "the file cannot be looked at: ", problem.value());
    if (!std::filesystem::exists(status))
        throw Error(ErrorKind::bad_input, name + ": there is no such file", {}, ENOENT);
    if (!std::filesystem::is_regular_file(status)) refuse_hair(name, "this is not a regular file");
    const std::uint64_t size = std::filesystem::file_size(file, problem);
    std::ifstream stream(file, std::ios::binary);
    if (problem || !stream) refuse_unreadable(name, "the file cannot be opened: ", problem ? problem.value() : errno);
    const auto copy = [&](std::uint64_t offset, void* to, std::size_t n) {
        errno = 0;
        if (stream.seekg(static_cast<std::streamoff>(offset)) &&
            stream.read(static_cast<char*>(to), static_cast<std::streamsize>(n)))
            return;
        if (stream.bad()) refuse_unreadable(name, "the file could not be read to its end: ", errno);
        refuse_hair(name, "the file could not be read to its end");
    };
    try {
        return body(HairSource{name, size, copy});
    } catch (const std::bad_alloc&) {
        throw Error(ErrorKind::out_of_resources,
                    name + ": not enough memory for a file of " + std::to_string(size) + " bytes");
    }
}

}  // namespace

Groom read_groom(const std::filesystem::path& file, const HairReadSettings& settings) {
    return with_file(file, [&](const HairSource& source) { return read(source, settings); });
}

void check_groom(const std::filesystem::path& file) {
    with_file(file, [](const HairSource& source) { reader_of(source).check(source); });
}

Groom read_groom(std::span<const std::byte> bytes, const std::string& name, const HairReadSettings& settings) {
    const auto copy = [&](std::uint64_t offset, void* to, std::size_t n) {
        if (offset > bytes.size() || n > bytes.size() - offset)
            refuse_hair(name, "the file could not be read to its end");
        if (n > 0) std::memcpy(to, bytes.data() + offset, n);
    };
    return read({name, bytes.size(), copy}, settings);
}

HairModel read_hair(const std::filesystem::path& file, const HairReadSettings& settings) {
    return read_groom(file, settings).model;
}

HairModel read_hair(std::span<const std::byte> bytes, const std::string& name) { return read_groom(bytes, name).model; }

bool is_hair_file(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) refuse_unreadable(file.string(), "", errno);
    std::array<std::byte, recognition_bytes> bytes{};
    stream.read(reinterpret_cast<char*>(bytes.data()), bytes.size());
    const auto count = static_cast<std::size_t>(stream.gcount());
    return reader_of_bytes(std::span(bytes).first(count)) || reader_of_name(file.string());
}

}  // namespace hairbake
