// Measures the difference between two results.
#pragma once

#include <filesystem>
#include <string>

namespace hairbake {

/// The differences of two results, as a JSON object, and whether they count as equal.
struct ComparisonReport {
    std::string json;
    bool equal = false;
};

/// Compares the arrays of two result folders: every .npy file that either manifest lists. They are equal when both have
/// the same arrays, and no value differs by more than `tolerance` times the largest absolute value of its array (of its
/// map) in the first; with 0, when all values are equal. The JSON object has
/// - first, second: the folders; tolerance; equal; same: whether all values are equal;
/// - for each array its name without ".npy" and the statistics of second - first: values (their number), max_abs, rms,
///   bias, largest (the largest absolute value of the first), rms_over_largest and max_over_largest. A NaN on either
///   side makes every figure null, and the arrays different;
/// - a set of cube maps ([M + 1, 6, n, n, 3], or more leading axes) has one entry for each map: specular_00 and so on;
/// - an array that only one folder has, or that has two shapes, has a sentence instead.
/// Throws Error(bad_input) when a folder is no result, or when the two have no .npy file in common.
ComparisonReport compare(const std::filesystem::path& first, const std::filesystem::path& second, double tolerance = 0);

/// A report of compare() as a table for people: whether they are equal, then one line for each entry.
std::string as_table(const std::string& report);

}  // namespace hairbake
