// Transmittance of uniform media by closed form or by quadrature in double precision.
#pragma once

namespace hairbake::test_support {

/// Mean over directions of exp(-extinction * way out) at distance r from the centre of a ball:
/// 1/2 int_{-1}^{1} exp(-extinction * s(mu)) dmu, s = -r mu + sqrt(R^2 - r^2 (1 - mu^2)). At the centre exp(-extinction
/// R), at the surface 1/2 (1 + (1 - exp(-2 extinction R)) / (2 extinction R)).
double ball_transmittance(double extinction, double radius, double r);

/// Centre of a ball of parallel fibres: 1/2 int_0^pi sin(theta) exp(-depth sin(theta)) dtheta, depth across the fibres.
double parallel_ball_centre(double depth);

/// Exponential integral E2(x) = int_1^infinity exp(-x t) / t^2 dt = exp(-x) - x E1(x).
double e2(double x);

/// At height z of an infinite slab of thickness h: 1/2 (E2(extinction z) + E2(extinction (h - z))).
double slab_transmittance(double extinction, double h, double z);

}  // namespace hairbake::test_support
