// Measures the difference between two results.
#pragma once

#include <filesystem>
#include <string>

namespace hairbake {

/// Compares the arrays of two result folders: every .npy file that either manifest lists. Returns a JSON object:
/// - first, second: the folders; same: whether both have the same arrays with equal values;
/// - for each array its name without ".npy" and the statistics of second - first: values (their number), max_abs, rms,
///   bias, largest (the largest absolute value of the first) and rms_over_largest. A NaN on either side makes every
///   figure null;
/// - a set of cube maps ([M + 1, 6, n, n, 3], or more leading axes) has one entry for each map: specular_00 and so on;
/// - an array that only one folder has, or that has two shapes, has a sentence instead.
/// Throws Error(bad_input) when a folder is no result, or when the two have no .npy file in common.
std::string compare(const std::filesystem::path& first, const std::filesystem::path& second);

/// A report of compare() as a table for people, one line for each entry.
std::string as_table(const std::string& report);

}  // namespace hairbake
