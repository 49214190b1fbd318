// Pictures as OpenEXR and PNG bytes, made by OpenImageIO in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/vec.h"
#include "core/environment/color_primaries.h"
#include "core/output/map_metadata.h"

namespace hairbake {

/// OpenEXR: float32 RGB, ZIP compressed, scanlines. `pixels` is [height * width], rows from the top. The attribute
/// `chromaticities` says the primaries where they are known.
/// Throws Error(out_of_resources) or Error(internal) with OpenImageIO's words.
std::vector<std::byte> encode_exr(const std::vector<Vec3f>& pixels, int width, int height, const Metadata& metadata,
                                  const std::optional<Chromaticities>& primaries = {});

/// PNG: 8-bit sRGB. `rgb` is [height * width * 3], rows from the top.
/// Throws as encode_exr().
std::vector<std::byte> encode_png(const std::vector<std::uint8_t>& rgb, int width, int height,
                                  const Metadata& metadata);

}  // namespace hairbake
