// Sets of sample directions on the unit sphere. All vertices of a bake share one set.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "core/base/vec.h"
#include "core/visibility/transmittance_settings.h"

namespace hairbake {

std::string_view name_of(DirectionSet set);

/// `count` unit directions, uniform over the sphere. The same arguments give the same directions on every machine.
///
/// count: 1 to 4096; a square number for `stratified`
/// seed:  of the sets `stratified` and `random`
///
/// Throws Error(usage) with the field for a count that is not allowed.
std::vector<Vec3d> make_directions(DirectionSet set, int count, std::uint64_t seed);

}  // namespace hairbake
