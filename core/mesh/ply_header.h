// The header of a PLY file. Private to core/mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hairbake {

enum class PlyFormat { ascii, little_endian, big_endian };

/// The types of numbers, by their sizes in binary files.
enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::size_t size_of(PlyType type);

struct PlyProperty {
    std::string name;
    PlyType type;                         ///< of the number, or of the items of a list
    std::optional<PlyType> count_type{};  ///< of the number of items; only for a list
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;
};

struct PlyHeader {
    PlyFormat format = PlyFormat::ascii;
    std::vector<PlyElement> elements;  ///< in the order of their data
    std::size_t bytes = 0;             ///< the data begin here
    std::size_t lines = 0;             ///< of the header
};

/// Reads the header at the beginning of `text`. Its lines end with LF, CR LF or CR, as the first one does.
/// Throws Error(bad_input) naming file and line.
PlyHeader read_ply_header(std::string_view text, const std::string& name);

}  // namespace hairbake
