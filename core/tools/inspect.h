// Facts of the files that hairbake reads and writes.
#pragma once

#include <filesystem>
#include <string>

#include "core/base/progress.h"

namespace hairbake {

/// Returns a JSON object. Its `kind` tells what `path` is, which is decided by the content:
/// - "hair model": strands, points, arrays, bounds; the smallest, mean and largest width (`thickness`);
/// - "mesh": format, faces, triangles, orientation, bounds;
/// - "environment map" (a file, a folder or a pattern of six faces): size, layout, format, brightest pixel, energy,
///   pixels that need repair;
/// - "bake result" (a folder, or its manifest.json): the blocks of its manifest that are short, and the sizes of its files.
/// Throws Error(bad_input) for anything else, naming the file.
/// Throws Error(cancelled).
std::string inspect(const std::filesystem::path& path, Progress& progress);

/// The JSON object of inspect() as aligned lines for people: names on the left, values on the right.
std::string as_lines(const std::string& json_object);

}  // namespace hairbake
