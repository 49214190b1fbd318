// Half floats (IEEE binary16), which graphics cards read: 11 bits, up to 65,504, normal from 2^-14.
//
// Radiance goes beyond both ends, so halves are stored with a scale: the value is the stored half times the scale. The
// scale is a power of two, which costs no precision. Everything here is thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/result/map_set.h"

namespace hairbake {

/// The bits of a half float; files hold them little-endian.
using Half = std::uint16_t;
using Half4 = std::array<Half, 4>;

constexpr float largest_half = 65504;

/// The half nearest to `value`, of two equally near the even one. Infinite from 65,520 on, NaN for NaN.
Half to_half(float value);

/// The scale for values up to `largest` in magnitude:
/// - 1 where `largest` is 0 or from 1/16 to 65,504. A reader that ignores the scale is then right, and a value 2^10
///   times smaller than the largest still has all bits.
/// - Otherwise the power of two that takes `largest` into (32752, 65504], but never below 2^-126, so that a reader's
///   float holds it.
/// Throws Error(bad_input) when `largest` is not finite.
double half_scale(double largest);

/// One scale for all maps of a bake, so that a shader needs one number.
/// Throws Error(bad_input) naming the map, face, row and column of a value that is not finite.
double half_scale(const MapSet& maps);

/// RGBA texels of value / scale with alpha 1, in the order of `texels`. (Cards need not take RGB alone as a texture
/// format.)
std::vector<Half4> to_half_texels(const CubeTexels& texels, double scale);

}  // namespace hairbake
