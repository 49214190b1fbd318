// Headers of Radiance HDR and PFM files, as far as OpenImageIO does not read them: line ends, axis order, exposure,
// primaries and the reasons for which a file cannot be read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/vec.h"
#include "core/environment/color_primaries.h"

namespace hairbake {

/// Where a stored scan line's pixels belong. Scan line i is row i, or column i when `columns` says so.
struct AxisOrder {
    bool columns = false;                          ///< scan lines are columns
    bool from_right = false, from_bottom = false;  ///< pixels or scan lines run leftwards, upwards
    bool is_usual() const { return !columns && !from_right && !from_bottom; }
};

/// A header in the form that OpenImageIO reads, and the facts that it would lose.
struct ImageHeader {
    std::string text;              ///< header to read instead of the file's first bytes; axis order as usual
    std::uint64_t data_begin = 0;  ///< of the pixels in the file, in bytes
    AxisOrder order;
    /// Values of the pixels are radiance times this, per channel (product of EXPOSURE and COLORCORR).
    Vec3d exposure{1, 1, 1};
    std::optional<Chromaticities> primaries;
    bool xyz = false;  ///< the pixels are CIE XYZ in candelas per square metre
};

/// Reads the header of a Radiance HDR file (format page of Radiance, "Picture file format").
///   start       the file's first bytes, at most 64 KiB
///   file_bytes  length of the file
/// Throws std::invalid_argument with the fault, without the file's name.
ImageHeader read_radiance_header(std::string_view start, std::uintmax_t file_bytes);

/// Reads the header of a PFM file. Empty unless its lines end with CR LF, in which case OpenImageIO would take the last
/// LF for a pixel's byte.
std::optional<ImageHeader> read_pfm_header(std::string_view start);

/// Puts pixels that were read as usual scan lines where the axis order says that they belong.
///   width, height  of the picture as it is seen
///   pixels         [height * width]; scan lines in the order of the file at first
void put_in_order(const AxisOrder& order, int width, int height, std::vector<Vec3f>& pixels);

/// Divides the pixels by the header's exposure. Returns a warning that says so, empty where there was nothing to do.
std::string take_off_exposure(const ImageHeader& header, std::vector<Vec3f>& pixels);

/// Turns pixels of CIE XYZ into radiance in RGB of Radiance's primaries, as ra_xyze of Radiance does: 179 candelas per
/// square metre are 1 watt per steradian and square metre. Returns a warning that says so, empty where there was nothing
/// to do.
std::string take_xyz(const ImageHeader& header, std::vector<Vec3f>& pixels);

}  // namespace hairbake
