#include "core/hair/hair_file.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <new>
#include <system_error>

#include "core/base/error.h"
#include "core/hair/hair_source.h"
#include "core/hair/tfx_file.h"

namespace hairbake {
namespace {

/// The extension decides only who refuses a file that begins as neither.
bool named_tfx(const std::string& name) {
    const std::string extension = std::filesystem::path(name).extension().string();
    return extension == ".tfx" || extension == ".TFX";
}

HairModel read(const HairSource& source) {
    std::array<std::byte, 4> begin{};
    source.copy(0, begin.data(), static_cast<std::size_t>(std::min<std::uint64_t>(source.size, begin.size())));
    const bool hair = std::memcmp(begin.data(), "HAIR", 4) == 0;
    return begins_as_tfx(begin) || (!hair && named_tfx(source.name)) ? read_tfx_format(source)
                                                                     : read_hair_format(source);
}

}  // namespace

HairModel read_hair(const std::filesystem::path& file) {
    const std::string name = file.string();
    std::error_code problem;
    const auto status = std::filesystem::status(file, problem);
    if (!std::filesystem::exists(status)) refuse_hair(name, "there is no such file");
    if (!std::filesystem::is_regular_file(status)) refuse_hair(name, "this is not a regular file");
    const std::uint64_t size = std::filesystem::file_size(file, problem);
    std::ifstream stream(file, std::ios::binary);
    if (problem || !stream) refuse_hair(name, "the file cannot be opened: " + std::generic_category().message(errno));
    try {
        return read({name, size, [&](std::uint64_t offset, void* to, std::size_t n) {
                         if (!stream.seekg(static_cast<std::streamoff>(offset)) ||
                             !stream.read(static_cast<char*>(to), static_cast<std::streamsize>(n)))
                             refuse_hair(name, "the file could not be read to its end");
                     }});
    } catch (const std::bad_alloc&) {
        throw Error(ErrorKind::out_of_resources,
                    name + ": not enough memory for a file of " + std::to_string(size) + " bytes");
    }
}

HairModel read_hair(std::span<const std::byte> bytes, const std::string& name) {
    return read({name, bytes.size(), [&](std::uint64_t offset, void* to, std::size_t n) {
                     if (offset > bytes.size() || n > bytes.size() - offset)
                         refuse_hair(name, "the file could not be read to its end");
                     if (n > 0) std::memcpy(to, bytes.data() + offset, n);
                 }});
}

bool is_hair_file(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) refuse_hair(file.string(), std::generic_category().message(errno));
    std::array<char, 4> begin{};
    stream.read(begin.data(), begin.size());
    return std::memcmp(begin.data(), "HAIR", 4) == 0 || begins_as_tfx(std::as_bytes(std::span(begin))) ||
           named_tfx(file.string());
}

}  // namespace hairbake
