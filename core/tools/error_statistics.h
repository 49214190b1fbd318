// Shared by the comparisons of results and of pictures. Private to core/tools.
#pragma once

#include <cmath>

namespace hairbake {

/// The larger of the two. Once `worst` is NaN it stays NaN, and a NaN `value` makes it NaN; std::max would lose it.
inline double worse(double worst, double value) { return std::isnan(worst) || value <= worst ? worst : value; }

}  // namespace hairbake
