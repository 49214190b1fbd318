// Luminance of linear RGB.
#pragma once

#include "core/base/vec.h"

namespace hairbake {

/// Rec. 709 luminance of linear RGB, in the precision of its argument.
template <class T>
constexpr T luminance(const Vec3<T>& rgb) {
    return T(0.2126) * rgb.x + T(0.7152) * rgb.y + T(0.0722) * rgb.z;
}

}  // namespace hairbake
