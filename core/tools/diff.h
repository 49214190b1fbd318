// Measures the difference between two pictures.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/base/progress.h"

namespace hairbake {

/// Compares two linear pictures and returns a JSON object: width, height, and over all pixels and channels rmse,
/// max_abs, bias, mean (of the first) and rmse_over_mean of second - first; "lit" has pixels, rmse, bias, mean and
/// rmse_over_mean over the pixels where either picture is not black. A NaN on either side makes every figure null.
/// - first, second: floating-point pictures (OpenEXR, HDR, PFM) of one size, at most 16384 x 16384.
/// - picture: a .png to write the difference to, in false colours: each pixel's largest |second - first| over the
///   channels, from black (0) over blue, red and yellow to white (`scale` and more), NaN in green. A labelled scale
///   stands below.
/// - scale: > 0; without one, the largest difference, rounded up to 1, 2 or 5 times a power of ten. The report states
///   it.
/// Throws Error(bad_input) naming the file when it is no such picture or has another size.
/// Throws Error(usage) for a scale that is not positive or a picture with another ending.
/// Throws Error(cancelled).
std::string diff(const std::filesystem::path& first, const std::filesystem::path& second,
                 const std::optional<std::filesystem::path>& picture, std::optional<double> scale, Progress& progress);

/// Removes the unfinished part of `picture` that an interrupted diff() leaves.
void discard_diff_part(const std::filesystem::path& picture) noexcept;

/// A report of diff() as lines for people.
std::string diff_as_lines(const std::string& report);

}  // namespace hairbake
