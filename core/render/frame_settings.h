// Size, sampling and content of a picture.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/names.h"

namespace hairbake {

/// The value of a pixel.
enum class Channel {
    beauty,         ///< linear radiance: all lobes on hair, the mesh, the background
    transmittance,  ///< FiberLight::transmittance, in all three channels
    diffuse,        ///< the beauty's diffuse lobes on hair, Kd applied
    specular,       ///< its specular lobes, Ks applied
    tangent         ///< the strand's tangent, each component in [-1, 1]
};
inline constexpr std::array channel_names{
    EnumName{Channel::beauty, "beauty"},   EnumName{Channel::transmittance, "transmittance"},
    EnumName{Channel::diffuse, "diffuse"}, EnumName{Channel::specular, "specular"},
    EnumName{Channel::tangent, "tangent"},
};
constexpr std::string_view name_of(Channel channel) { return name_in(channel_names, channel); }

/// Whether the channel shows light.
constexpr bool is_light(Channel channel) { return channel != Channel::transmittance && channel != Channel::tangent; }

struct FrameSettings {
    int width = 0, height = 0;  ///< 1 to 16384 each
    int samples = 1;            ///< of a pixel, 1 to 65536; box filter
    std::uint64_t seed = 1;
    Channel channel = Channel::beauty;
};

}  // namespace hairbake
