// Generates skies from a seed.
#pragma once

#include <cstdint>
#include <string_view>

#include "core/environment/environment_map.h"

namespace hairbake {

enum class Sky {
    sunny,    ///< blue sky, clouds, ground and a sun 0.53 degrees across with about 60 % of the light in it
    studio,   ///< a dim room with four small, very bright lamps
    overcast  ///< clouds over the whole sky (CIE overcast, Moon and Spencer 1942), no lamp
};

/// "sunny", "studio", "overcast".
std::string_view name_of(Sky sky);

/// A lat-long map of `width` x width/2 pixels (convention gltf, no rotation), linear Rec.709, mean radiance about 0.5.
/// `width` is even, 16 to 4096. The same seed gives the same scene at every size: the flux of the sun and the lamps is
/// shared out to the texels that they cover, and everything else is evaluated at the centre of each texel. Runs on
/// all threads and gives the same bytes for any number of them.
/// Throws Error(usage) for a width out of range.
EnvironmentMap generate_sky(Sky sky, int width, std::uint64_t seed);

}  // namespace hairbake
