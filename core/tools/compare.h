// How far two results are apart.
#pragma once

#include <filesystem>
#include <string>

namespace hairbake {

/// Statistics of second - first for transmittance and each map, from the .npy files of two result folders, as a
/// JSON object: values, max_abs, rms, bias, largest (the largest absolute value of the first) and rms_over_largest;
/// what only one of them has, or has in another shape, is named. "same" says whether all values are equal. Throws
/// Error(bad_input) when a folder is no result or they have no .npy file in common.
std::string compare(const std::filesystem::path& first, const std::filesystem::path& second);

/// A report of compare() as a table for people, one line an array.
std::string as_table(const std::string& report);

}  // namespace hairbake
