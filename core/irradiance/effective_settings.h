// The request's `effective_transmittance` block.
#pragma once

#include <array>

#include "core/base/names.h"

namespace hairbake {

enum class EffectiveDiffuse {
    rgb,       ///< a number for each channel of the light
    luminance  ///< one number, of the Rec. 709 luminance
};
inline constexpr std::array effective_diffuse_names{EnumName{EffectiveDiffuse::rgb, "rgb"},
                                                    EnumName{EffectiveDiffuse::luminance, "luminance"}};

/// The request's `effective_transmittance` block.
struct EffectiveSettings {
    bool enabled = false;
    int lights = 64;  ///< directions that stand for the environment at exponents up to 64, 1 to 1024
    int cosines = 3;  ///< terms of the specular part, 1 to 5
    EffectiveDiffuse diffuse = EffectiveDiffuse::rgb;
    int reference_neighborhoods = 256;  ///< traced for the error bar, 0 to 100000

    int diffuse_components() const { return diffuse == EffectiveDiffuse::rgb ? 3 : 1; }
    int components() const { return diffuse_components() + cosines; }
};

}  // namespace hairbake
