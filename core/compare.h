// How far two results are apart.
#pragma once

#include <filesystem>
#include <string>

namespace hairbake {

/// Statistics of second - first for transmittance and each map, from the .npy files of two result folders, as a
/// JSON object: values, max_abs, rms, bias, largest (the largest absolute value of the first) and rms_over_largest;
/// what only one of them has is named. "same" says whether all values are equal. Throws Error(bad_input) when a folder
/// is no result, has no .npy files, or the shapes differ.
std::string compare(const std::filesystem::path& first, const std::filesystem::path& second);

}  // namespace hairbake
