#include "core/output/npy.h"

#include <bit>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <system_error>

#include "core/base/error.h"

namespace hairbake {
namespace {

static_assert(std::endian::native == std::endian::little, "npy data is written as it lies in memory");
static_assert(sizeof(Vec3f) == 3 * sizeof(float));

constexpr std::string_view magic{"\x93NUMPY\x01\x00", 8};

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& what) {
    throw Error(ErrorKind::bad_input,
                file.string() + " " + what + "; allowed is what hairbake writes: .npy version 1.0, '<f4', C order");
}

/// The header's dictionary; the stream is left at the data.
std::string read_dictionary(std::ifstream& stream, const std::filesystem::path& file) {
    char start[10];
    if (!stream.read(start, sizeof start) || std::string_view(start, 8) != magic)
        refuse(file, "is not .npy version 1.0");
    const std::size_t length = static_cast<unsigned char>(start[8]) + 256u * static_cast<unsigned char>(start[9]);
    std::string dictionary(length, ' ');
    if (!stream.read(dictionary.data(), static_cast<std::streamsize>(length))) refuse(file, "ends within its header");
    return dictionary;
}

/// The numbers between the parentheses of the shape; the rest of the dictionary is one fixed text.
std::vector<std::size_t> parse_shape(const std::string& dictionary, const std::filesystem::path& file) {
    constexpr std::string_view before = "{'descr': '<f4', 'fortran_order': False, 'shape': (";
    const std::size_t end = dictionary.find("), }");
    const bool fixed = dictionary.starts_with(before) && end != std::string::npos &&
                       dictionary.find_first_not_of(" \n", end + 4) == std::string::npos;
    if (!fixed) refuse(file, "has the header " + dictionary.substr(0, 80));
    std::vector<std::size_t> shape;
    for (std::size_t i = before.size(); i < end;) {
        std::size_t value = 0;
        const auto [stop, error] = std::from_chars(dictionary.data() + i, dictionary.data() + end, value);
        if (error != std::errc()) refuse(file, "has a shape that is no list of numbers");
        shape.push_back(value);
        i = static_cast<std::size_t>(stop - dictionary.data());
        if (i < end && dictionary[i] != ',') refuse(file, "has a shape that is no list of numbers");
        while (i < end && (dictionary[i] == ',' || dictionary[i] == ' ')) ++i;
    }
    return shape;
}

}  // namespace

std::string npy_header(std::span<const std::size_t> shape) {
    std::string text = "{'descr': '<f4', 'fortran_order': False, 'shape': (";
    for (std::size_t i = 0; i < shape.size(); ++i)
        text += std::to_string(shape[i]) + (i + 1 < shape.size() ? ", " : shape.size() == 1 ? "," : "");
    text += "), }";
    const std::size_t total = (magic.size() + 2 + text.size() + 1 + 63) / 64 * 64;
    text.resize(total - magic.size() - 2 - 1, ' ');
    text += '\n';
    std::string header(magic);
    header += static_cast<char>(text.size() & 255);
    header += static_cast<char>(text.size() >> 8);
    return header + text;
}

std::span<const std::byte> npy_data(std::span<const float> values) { return std::as_bytes(values); }
std::span<const std::byte> npy_data(std::span<const Vec3f> values) { return std::as_bytes(values); }

std::string shape_text(std::span<const std::size_t> shape) {
    std::string text = "[";
    for (const std::size_t n : shape) text += (text.size() > 1 ? ", " : "") + std::to_string(n);
    return text + "]";
}

NpyArray read_npy(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw Error(ErrorKind::bad_input, file.string() + ": " + std::generic_category().message(errno));
    NpyArray array;
    array.shape = parse_shape(read_dictionary(stream, file), file);

    const auto data = static_cast<std::uint64_t>(stream.tellg());
    const std::uint64_t available = (std::filesystem::file_size(file) - data) / sizeof(float);
    std::uint64_t count = 1;
    for (const std::size_t n : array.shape) {
        if (n != 0 && count > available / n) refuse(file, "holds fewer values than its shape says");
        count *= n;
    }
    if (data + count * sizeof(float) != std::filesystem::file_size(file)) refuse(file, "is longer than its shape says");
    array.values.resize(count);
    if (!stream.read(reinterpret_cast<char*>(array.values.data()), static_cast<std::streamsize>(count * sizeof(float))))
        refuse(file, "could not be read to its end");
    return array;
}

}  // namespace hairbake
