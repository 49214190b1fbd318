// Sets of sample directions on the unit sphere, shared by every vertex of a bake.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "core/base/vec.h"
#include "core/visibility/direction_set.h"
#include "core/visibility/transmittance_settings.h"

namespace hairbake {

std::string_view name_of(DirectionSet set);

/// `count` unit directions in [1, 4096], uniform over the sphere; the same (set, count, seed) gives the same
/// directions on every machine. Throws Error(usage) naming the field when count is out of range or, for
/// `stratified`, not a square.
std::vector<Vec3d> make_directions(DirectionSet set, int count, std::uint64_t seed);

}  // namespace hairbake
