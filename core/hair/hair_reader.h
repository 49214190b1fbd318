// The interface of the groom readers, and their table. Private to the readers and to hair_file.cpp.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "core/hair/groom.h"
#include "core/hair/hair_source.h"

namespace hairbake {

/// Bytes from the beginning of a file that recognise() gets; fewer where the file is shorter.
inline constexpr std::size_t recognition_bytes = 16;

/// One format of groom files.
struct HairReader {
    std::string_view name;       ///< of the format, for messages: "TressFX"
    std::string_view extension;  ///< in lower case with the dot: ".tfx"
    std::string_view beginning;  ///< how its files begin, for messages
    bool animated;               ///< whether read() looks at the time of the settings

    /// Whether a file that begins with `bytes` is of this format. Nothing else decides which reader gets a file.
    bool (*recognises)(std::span<const std::byte> bytes);

    /// Refuses what the header alone shows to be wrong, without reading the strands. `read` makes the same checks
    /// first. Like `read`, it is also called for a file that has this extension but begins as no known format.
    void (*check)(const HairSource& source);

    /// Reads the file. It is also called for a file that has this extension but begins as no known format; it must
    /// refuse such a file. Leaves `warnings` about the time to the caller. Errors: as read_groom() says.
    Groom (*read)(const HairSource& source, const HairReadSettings& settings);
};

/// All readers. A new reader is a file of its own and a line in hair_readers.cpp.
std::span<const HairReader* const> hair_readers();

/// Throws Error(bad_input) for a file that begins as none of the formats: what was found and what is allowed.
[[noreturn]] void refuse_beginning(const HairSource& source);

}  // namespace hairbake
