// An upper bound for the error of linear interpolation between the maps of neighbouring theta', for one environment.
#pragma once

#include "core/base/progress.h"
#include "core/base/vec.h"
#include "core/environment/light_set.h"
#include "core/fiber/fiber_model.h"
#include "core/irradiance/kernel_sum.h"

namespace hairbake {

/// Adds specular_maps - 1 rows to `table`. Row m bounds, for one light at the angle theta to a texel's tangent t, the
/// error of interpolating between maps m and m + 1 at any theta' between them. The bound holds for every tangent within
/// `radius` (radians) of t and of the light.
///
/// Sum such a row over the lights. The largest sum of all rows, over tangents that cover half the sphere with that
/// radius, is an upper bound, per channel, of |(1 - f) S_m(t) + f S_m+1(t) - S(t, theta')| for the texels that the
/// lights gather.
///
/// Method: the specular kernel depends on theta + theta' alone (ZonalKernels), so one light's error depends on theta +
/// theta'_m and f. Its absolute value is maximised over f and over angles within `radius` and one table step. 2 % are
/// added for the finite sampling. Absolute values add up, so the bound is loose for smooth environments and close for a
/// sun. The opposite tangents swap theta for pi - theta, which turns row m into row M - 1 - m: half the sphere is
/// enough.
void add_interpolation_rows(KernelTable& table, const ZonalKernels& kernels, int specular_maps, double radius);

/// Largest angle between a direction and the nearest texel centre of a cube: half a diagonal at a face's centre.
double texel_radius(int face_size);

/// The bound over the tangents of a 16 x 16 x 6 cube, without maps. Per channel, in the unit of the maps.
/// Throws Error(cancelled).
Vec3d interpolation_bound(const LightSet& lights, const ZonalKernels& kernels, int specular_maps,
                          const Progress& progress);

}  // namespace hairbake
