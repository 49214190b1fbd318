// Hair models from files: Cem Yuksel's HAIR format, read and written whole, and TressFX (.tfx), read.
#pragma once

#include <cstddef>
#include <filesystem>
#include <iosfwd>
#include <span>
#include <string>

#include "core/hair/hair_model.h"

namespace hairbake {

/// Reads a hair model, whatever the file's name, by its first bytes:
/// - "HAIR": every combination of the array bits but the points array, which the format demands;
/// - the number 3.0 or 4.0: a binary TressFX asset of that version; tfx_file.h says what of it is read.
/// Counts and offsets are checked against the file's size before memory is taken. Throws Error(bad_input) naming file,
/// strand and vertex, what was found and what is allowed: neither of these beginnings, counts that disagree, a
/// truncated or (HAIR) over-long file, an array outside the file, NaN, infinity or coordinates beyond 1e18 in
/// magnitude; Error(out_of_resources) when memory ends. Reentrant.
HairModel read_hair(const std::filesystem::path& file);

/// The same from memory; `name` stands for the file in messages. This is what the fuzzers call.
HairModel read_hair(std::span<const std::byte> bytes, const std::string& name);

/// Whether the file begins as one of the formats that read_hair() knows, or is named .tfx and so deserves its message.
/// Throws Error(bad_input) when it cannot be opened.
bool is_hair_file(const std::filesystem::path& file);

/// Writes the model in the HAIR format; reading the result gives the same model (but its `format`), and a HAIR model
/// that was read unchanged gives the same bytes. Throws Error(out_of_resources) naming the file when it cannot be
/// written whole, and Error(internal) for a model whose arrays contradict each other or whose strands the format cannot
/// hold (65,536 points each at most).
void write_hair(const HairModel& model, const std::filesystem::path& file);

/// The same to a stream, whose state tells whether all was written.
void write_hair(const HairModel& model, std::ostream& stream);

/// A copy of `model` whose colours are grey with the value of `transmittance` ([V], 0 to 1) and nothing else changed.
/// Throws Error(internal) when the sizes differ.
HairModel with_transmittance_as_colors(const HairModel& model, std::span<const float> transmittance);

}  // namespace hairbake
