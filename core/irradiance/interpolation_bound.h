// How wrong linear interpolation between the maps of neighbouring theta' can be for a given environment.
#pragma once

#include "core/base/progress.h"
#include "core/base/vec.h"
#include "core/environment/light_set.h"

namespace hairbake {

/// Upper bound, per channel, of |(1 - f) S_m(t) + f S_m+1(t) - S(t, theta')| over every tangent t and every theta'
/// between theta'_m and theta'_m+1, for the environment whose texels `lights` gathers; unit of the maps.
///
/// How: for one light at angle theta the error is e(theta + theta', f), so the error at t is at most the sum over
/// texels of flux * max over f of |e|. That sum is taken over 768 tangents (half of a 16 x 16 x 6 cube) and the kernel
/// is replaced by its maximum over all angles within (half diagonal of such a texel + radius of the light set + one
/// table step), so that it covers every tangent and every texel, not only those looked at. 2 % are added for the finite
/// sampling of e. The bound adds absolute values and is therefore loose for smooth environments, close for a sun.
Vec3d interpolation_bound(const LightSet& lights, double exponent, int specular_maps, const Progress& progress);

}  // namespace hairbake
