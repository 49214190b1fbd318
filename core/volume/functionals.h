// The table of the functionals that the volume method knows. A new functional is a file of its own, a declaration and a
// row here.
#pragma once

#include <array>
#include <memory>

#include "core/volume/functional.h"

namespace hairbake {

/// average, sh and bent_cone of every hair vertex (vertex_moments.cpp).
std::unique_ptr<Functional> make_vertex_moments(const FunctionalInput& input);
/// The receiver's means over the hemisphere (receiver_hemisphere.cpp).
std::unique_ptr<Functional> make_receiver_hemisphere(const FunctionalInput& input);

constexpr MakeFunctional kFunctionals[] = {make_vertex_moments, make_receiver_hemisphere};

}  // namespace hairbake
