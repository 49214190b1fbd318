// Facts of a file that hairbake reads or wrote.
#pragma once

#include <filesystem>
#include <string>

#include "core/base/progress.h"

namespace hairbake {

/// Facts of a hair model (strands, points, arrays, bounds, widths), an environment (size, layout, format,
/// brightest pixel, energy, what its pixels need repaired; a file, a folder or a pattern of six faces) or a result
/// folder (its manifest in short), as a JSON object. What `path` is shows from what it holds, not from its name. Throws
/// Error(bad_input), Error(cancelled).
std::string inspect(const std::filesystem::path& path, Progress& progress);

/// The JSON object of inspect() as aligned lines for people: names on the left, values on the right.
std::string as_lines(const std::string& json_object);

}  // namespace hairbake
