// preview.png: everything that a bake gave on one labelled sheet.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/output/file_sink.h"
#include "core/result/bake_result.h"

namespace hairbake {

/// With hair: the groom in its transmittance from front and side, and the histogram of A. With an environment: the
/// diffuse map and the specular maps (at most 36 of them, evenly chosen) as lat-long pictures, tone-mapped with
/// the exposure that the sheet names. Adds to `warnings` when the labels' font is missing.
WrittenFile write_preview(const BakeResult& result, const std::filesystem::path& folder,
                          std::vector<std::string>& warnings);

}  // namespace hairbake
