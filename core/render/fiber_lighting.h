// How the light that a strand sends to the eye is found: one implementation for each shading mode.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "core/base/progress.h"
#include "core/base/vec.h"
#include "core/irradiance/irradiance_maps.h"
#include "core/reference/vertex_rays.h"
#include "core/render/first_hit.h"
#include "core/render/light_sum.h"
#include "core/render/vertex_transmittance.h"

namespace hairbake {

/// A point of a strand that the camera sees.
struct StrandPoint {
    StrandPlace place;
    Vec3d tangent;           ///< unit, root to tip
    Vec3d to_eye;            ///< unit
    std::uint64_t seed = 0;  ///< of what is drawn at random there
};

/// Light that arrives through the diffuse and the specular kernel, what hides it taken off: radiance times steradian,
/// Kd and Ks not applied. `transmittance` is A, or, where a mode has none, the share of the diffuse light (sum of the
/// channels) that arrives.
struct FiberLight {
    double transmittance = 1;
    Vec3d diffuse, specular;
};

/// Thread-safe.
class FiberLighting {
public:
    virtual ~FiberLighting() = default;

    /// Sizes equal. Throws Error(cancelled).
    virtual void light(std::span<const StrandPoint> points, std::span<FiberLight> result,
                       const Progress& progress) const = 0;
};

// Each refers to its arguments, which must outlive it.

/// A(x) D(t) and A(x) S(t, theta') from the maps, with the interpolation of the run time (irradiance/lookup.h).
std::unique_ptr<FiberLighting> baked_lighting(const VertexTransmittance& transmittance, const IrradianceMaps& maps);

/// A(x), and no light: for pictures of the transmittance and of the tangents, which need none.
std::unique_ptr<FiberLighting> average_lighting(const VertexTransmittance& transmittance);

/// A(x) times the sum over every light with the exact kernels: no maps.
std::unique_ptr<FiberLighting> brute_lighting(const VertexTransmittance& transmittance, const LightSum& lights);

/// The sum over every light with the transmittance inside: T(x, l) from spherical harmonics (clamped to [0, 1]) or from
/// the bent cone, whichever `transmittance` gives.
std::unique_ptr<FiberLighting> directional_lighting(const DirectionalTransmittance& transmittance,
                                                    const LightSum& lights);

/// Xing 2012, equation 1: the sum over the lights with the traced transmittance of each direction inside. At every
/// point, `light_samples` lights are drawn (stratified) with the probability of what they would send through the
/// diffuse kernel if nothing hid them, and as many for the specular one; each sends a shadow ray, with the tracer's own
/// rules, from one of the segment's two vertices (drawn, so that the mean is linear between them as A is). Unbiased.
/// `guess` only makes it less noisy: it is a control variate for the lights' colours, so that the answer is exact where
/// T = guess everywhere.
std::unique_ptr<FiberLighting> reference_lighting(VertexRays rays, const VertexTransmittance& guess,
                                                  const LightSum& lights, int light_samples);

}  // namespace hairbake
