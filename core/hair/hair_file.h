// Reads groom files of every known format.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "core/hair/groom.h"

namespace hairbake {

/// Reads a groom file. Its first bytes decide the format, whatever its name:
/// - "HAIR": Cem Yuksel's format (hair_format.h);
/// - the number 3.0 or 4.0 as a float: a binary TressFX asset of that version (tfx_reader.h).
/// Where the first bytes match no format, the name's extension chooses the reader whose message refuses the file.
///
/// - file: a regular file. Counts and offsets are checked against its size before memory is taken.
/// - settings: a time other than 0 gives a warning where the format holds no animation.
///
/// Reentrant.
/// Throws Error(bad_input) naming file, strand and vertex, what was found and what is allowed: an unknown beginning,
/// counts that disagree, a truncated or (HAIR) over-long file, an array outside the file, NaN, infinity or coordinates
/// beyond 1e18 in magnitude.
/// Throws Error(out_of_resources) when memory ends.
Groom read_groom(const std::filesystem::path& file, const HairReadSettings& settings = {});

/// Makes those checks of read_groom() that need only the file's header, and reads no more than that.
/// Throws the same errors with the same words.
void check_groom(const std::filesystem::path& file);

/// The same as read_groom() from memory; `name` stands for the file in messages. The fuzzers call this one.
Groom read_groom(std::span<const std::byte> bytes, const std::string& name, const HairReadSettings& settings = {});

/// The model alone, for callers that have no use for the rest.
HairModel read_hair(const std::filesystem::path& file, const HairReadSettings& settings = {});
HairModel read_hair(std::span<const std::byte> bytes, const std::string& name);

/// Whether the file begins as one of the formats that read_groom() knows, or has the extension of one. In the second
/// case read_groom() refuses it with the message of that reader.
/// Throws Error(bad_input) when the file cannot be opened.
bool is_hair_file(const std::filesystem::path& file);

}  // namespace hairbake
