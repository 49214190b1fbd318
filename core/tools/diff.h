// How far two pictures are apart.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/base/progress.h"

namespace hairbake {

/// Statistics of second - first for two linear pictures (OpenEXR, HDR, PFM) of one size, at most 16384 x 16384, as a
/// JSON object: width, height, and over all pixels and channels rmse, max_abs, bias, mean (of the first),
/// rmse_over_mean; "lit" has pixels, rmse, bias, mean and rmse_over_mean over the pixels where either is not black. A
/// NaN on either side makes every figure NaN (null). With `picture` (a .png), writes the difference in false colours:
/// each pixel's largest |second - first| over the channels, from black (0) over blue, red and yellow to white (`scale`
/// and more; without one the largest difference, rounded up to 1, 2 or 5 times a power of ten), NaN in green, with a
/// labelled scale below; "scale" tells it. Throws Error(bad_input) naming the file for what is no picture or has
/// another size, Error(usage) for a scale that is not positive or another ending.
std::string diff(const std::filesystem::path& first, const std::filesystem::path& second,
                 const std::optional<std::filesystem::path>& picture, std::optional<double> scale, Progress& progress);

/// Removes what a diff() that does not end has written of `picture`.
void discard_diff_part(const std::filesystem::path& picture) noexcept;

/// A report of diff() in lines for people.
std::string diff_as_lines(const std::string& report);

}  // namespace hairbake
