// Light that a strand sends to the eye: one implementation for each shading mode.
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
    FiberView view;          ///< unit tangent from root to tip, unit direction to the eye
    std::uint64_t seed = 0;  ///< of the random lights of the mode reference
};

/// Light that arrives through each lobe of the fibre model, after other strands and the occluder have blocked their
/// part: radiance times steradian, Kd and Ks not applied. `transmittance` is A; in a mode without A it is the share of
/// the first lobe's light (sum of the channels) that arrives.
struct FiberLight {
    double transmittance = 1;
    LobeSums lobes;
};

/// Thread-safe.
class FiberLighting {
public:
    virtual ~FiberLighting() = default;

    /// Fills `result`, which has the size of `points`.
    /// Throws Error(cancelled).
    virtual void light(std::span<const StrandPoint> points, std::span<FiberLight> result,
                       const Progress& progress) const = 0;
};

// Each object refers to its arguments, which must outlive it.

/// A(x) D(t) and A(x) S(t, theta') from the maps of a model with zonal kernels, with the interpolation of the run time
/// (irradiance/lookup.h).
std::unique_ptr<FiberLighting> baked_lighting(const VertexTransmittance& transmittance, const IrradianceMaps& maps);

/// Ad(x) D(t) and As(x, theta') S(t, theta') from the same maps: two look-ups, with the transmittance inside the
/// integral.
std::unique_ptr<FiberLighting> effective_lighting(const EffectiveTransmittance& transmittance,
                                                  const IrradianceMaps& maps);

/// A(x) without light: for pictures of the transmittance and of the tangents.
std::unique_ptr<FiberLighting> average_lighting(const VertexTransmittance& transmittance);

/// A(x) times the sum over every light with the exact kernels: no maps.
std::unique_ptr<FiberLighting> brute_lighting(const VertexTransmittance& transmittance, const LightSum& lights);

/// The sum over every light with the transmittance inside: T(x, l) from spherical harmonics (clamped to [0, 1]) or from
/// the bent cone, whichever of the two `transmittance` holds.
std::unique_ptr<FiberLighting> directional_lighting(const DirectionalTransmittance& transmittance,
                                                    const LightSum& lights);

/// Xing 2012, equation 1: the sum over the lights with the traced transmittance of each direction inside.
///   rays           the tracer's shadow rays
///   guess          A(x), a control variate: it reduces the noise and does not bias the result, which is exact where
///                  T = guess everywhere
///   lights         the environment and the fibre model
///   light_samples  lights drawn for each lobe at every point
/// For each lobe, lights are drawn (stratified) in proportion to the energy that they would send through that lobe if
/// nothing blocked them. Each sends a shadow ray by the tracer's own rules from one of the segment's two vertices. The
/// vertex is drawn as well, so that the mean is linear between them as A is. Unbiased.
std::unique_ptr<FiberLighting> reference_lighting(VertexRays rays, const VertexTransmittance& guess,
                                                  const LightSum& lights, int light_samples);

}  // namespace hairbake
