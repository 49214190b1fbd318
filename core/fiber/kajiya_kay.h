// The hair model of Kajiya and Kay (1989): its kernels over the sphere and their zonal spherical-harmonic coefficients.
//
// Every kernel contains the cosine of the light's angle to the normal plane (fiber_model.h); Kd and Ks are not applied.
// Thread-safe.
#pragma once

#include <vector>

#include "core/base/vec.h"

namespace hairbake {

/// sin(angle between `tangent` and `to_light`), both unit vectors, computed as |t x l|; in [0, 1].
/// Kajiya and Kay 1989; Xing 2012, section 3.
double kajiya_kay_diffuse(const Vec3d& tangent, const Vec3d& to_light);

/// max(0, sin_l sin_e - cos_l cos_e)^p = max(0, -cos(theta_l + theta_e))^p for unit vectors away from the hair; in [0,
/// 1], 1 in the mirror direction. p >= 0; p = 0 is the indicator of a positive cosine.
/// The minus sign (CS184) is right where both directions point away. Equations 6 to 8 of Xing 2012 lack the clamp; it
/// is applied here (docs/math.md, "The Kajiya-Kay kernels").
double kajiya_kay_specular(const Vec3d& tangent, const Vec3d& to_light, const Vec3d& to_eye, double exponent);

/// The specular kernel from angles to the tangent: max(0, cos(pi - theta_light - theta_view))^p (Xing 2012, section 3).
double kajiya_kay_specular(double theta_light, double theta_view, double exponent);

/// max(0, cosine)^p with p = 0 as the indicator of cosine > 0.
double clamped_power(double cosine, double exponent);

/// lambda_l = 2 pi * integral over x in [-1, 1] of sqrt(1 - x^2) P_l(x), l = 0 .. bands - 1, in closed form:
/// lambda_0 = pi^2, lambda_2n = lambda_2n-2 (2n-3)(2n-1) / (2n (2n+2)), odd ones 0.
std::vector<double> diffuse_zonal(int bands);

/// lambda_l = 2 pi * integral over x of max(0, cos(pi - acos(x) - theta_view))^p P_l(x), l = 0 .. bands - 1.
/// Gauss-Legendre with 256 nodes on the part of the support where the kernel exceeds 1e-20 of its peak. The error is
/// below 1e-12 for integer p and below 1e-5 for other p < 2, whose kernel is singular at the end of its support.
/// `exponent` is 0 to 8192, `bands` 1 to 128.
std::vector<double> specular_zonal(int bands, double exponent, double theta_view);

/// Integral of the squared kernel over the sphere; equals the sum over l of lambda_l^2 (2l + 1) / (4 pi).
double diffuse_energy();
double specular_energy(double exponent, double theta_view);

}  // namespace hairbake
