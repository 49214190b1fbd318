// Pictures as OpenEXR and PNG bytes, made by OpenImageIO in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/vec.h"
#include "core/output/map_metadata.h"

namespace hairbake {

/// OpenEXR: float32 RGB, ZIP compressed, scanlines. `pixels` is [height * width], rows from the top.
/// Throws Error(out_of_resources) or Error(internal) with OpenImageIO's words.
std::vector<std::byte> encode_exr(const std::vector<Vec3f>& pixels, int width, int height, const Metadata& metadata);

/// PNG: 8-bit sRGB. `rgb` is [height * width * 3], rows from the top.
/// Throws as encode_exr().
std::vector<std::byte> encode_png(const std::vector<std::uint8_t>& rgb, int width, int height,
                                  const Metadata& metadata);

}  // namespace hairbake
