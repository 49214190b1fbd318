// Writes hair models as HAIR files.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <span>
#include <string_view>

#include "core/hair/hair_file_extras.h"
#include "core/hair/hair_model.h"

namespace hairbake {

/// Writes a model in the HAIR format.
/// - model: reading the result gives it again, except for its `format`.
/// - file: replaced where it exists.
/// - extras: as read_groom() gave them. The model of a HAIR file with its own extras gives the same bytes that were
///   read.
/// Throws Error(out_of_resources) naming the file when it cannot be written whole.
/// Throws Error(internal) for a model whose arrays contradict each other, or whose strands the format cannot hold
/// (65,536 points each at most, except where extras.has_segments_array is false).
void write_hair(const HairModel& model, const std::filesystem::path& file, const HairFileExtras& extras = {});

/// The same to a stream, whose state tells whether all was written.
void write_hair(const HairModel& model, std::ostream& stream, const HairFileExtras& extras = {});

/// A copy of `model` whose colours are grey with the value of `transmittance` ([V], 0 to 1) and nothing else changed.
/// Throws Error(internal) when the sizes differ.
HairModel with_transmittance_as_colors(const HairModel& model, std::span<const float> transmittance);

/// Extras for a model that comes from no HAIR file: the model's defaults, a segments array, and `info` as free text,
/// cut off after 88 bytes.
HairFileExtras make_hair_file_extras(const HairModel& model, std::string_view info);

}  // namespace hairbake
