// The interface of the mesh readers, and their table. Private to the readers and to mesh_file.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "core/mesh/polygon_mesh.h"

namespace hairbake {

/// Bytes from the beginning of a file that recognises() and check() get; fewer where the file is shorter.
inline constexpr std::size_t mesh_header_bytes = 65536;

/// Coordinates are at most this large.
inline constexpr double farthest_coordinate = 1e18;

/// One format of mesh files. A byte order mark before a text has been taken away.
struct MeshReader {
    std::string_view name;       ///< of the format, for messages: "PLY"
    std::string_view beginning;  ///< how its files begin, for messages

    /// Whether a file that begins with `first` is of this format. Nothing else decides which reader gets a file.
    bool (*recognises)(std::span<const std::byte> first);

    /// Refuses what the beginning of the file shows to be wrong. `read` makes the same checks.
    ///   first: the first mesh_header_bytes of the file
    ///   size:  of the file, in bytes
    ///   name:  stands for the file in messages
    void (*check)(std::span<const std::byte> first, std::uint64_t size, const std::string& name);

    /// Reads the file.
    /// Throws Error(bad_input), as read_mesh() says.
    PolygonFile (*read)(std::span<const std::byte> bytes, const std::string& name);
};

/// The reader of a file that begins with `first`.
/// Throws Error(bad_input) for a file of no known format: what was found and what is allowed.
const MeshReader& reader_of_mesh(std::span<const std::byte> first, const std::string& name);

/// Throws Error(bad_input): "<name>: <what>".
[[noreturn]] void refuse_mesh(const std::string& name, const std::string& what);

/// A word of a file for a message, shortened, with unprintable characters replaced.
std::string quoted_word(std::string_view word);

}  // namespace hairbake
