// NumPy's .npy format, version 1.0: little-endian float32 in C order.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/base/vec.h"

namespace hairbake {

/// The bytes before the data: magic, version 1.0 and the dictionary, padded to a multiple of 64.
std::string npy_header(std::span<const std::size_t> shape);

/// The values' bytes as the file holds them.
std::span<const std::byte> npy_data(std::span<const float> values);
std::span<const std::byte> npy_data(std::span<const Vec3f> values);

struct NpyArray {
    std::vector<std::size_t> shape;
    std::vector<float> values;  ///< the product of the shape
};

/// "[2, 6, 4, 4, 3]", for messages.
std::string shape_text(std::span<const std::size_t> shape);

/// Reads a file of the kind that hairbake writes. Sizes are checked before memory is taken.
/// Throws Error(bad_input) naming the file for any other .npy (another type, Fortran order, another version), and for a
/// truncated or over-long one.
NpyArray read_npy(const std::filesystem::path& file);

}  // namespace hairbake
