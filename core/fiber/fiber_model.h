// The light that a fibre scatters: the interface of all fibre models.
//
// A model is a sum of lobes. A lobe is a kernel K(tangent, to light, to eye) over the sphere of lights. K contains the
// cosine of the light's angle to the normal plane, so that
//     outgoing radiance = sum over the lobes of coefficient * integral of K * radiance over all directions
// without a further cosine (docs/math.md, "Frame and angles"). Coefficients (Kd, Ks) belong to the caller.
// All directions are unit vectors that point away from the fibre; tangents run from root to tip.
//
// Models are immutable and thread-safe. A new model is one file that defines make_fiber_model() for its parameters, and
// its lines in fiber_settings.h.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/vec.h"
#include "core/fiber/fiber_settings.h"

namespace hairbake {

/// Lights that are evaluated together, and the most lobes that a model has.
inline constexpr std::size_t light_block = 256;
inline constexpr std::size_t most_lobes = 4;

/// The coefficient that scales a lobe, and the channel of a picture that shows it.
enum class LobeRole {
    diffuse,  ///< Kd
    specular  ///< Ks
};

struct FiberLobe {
    std::string_view name;
    LobeRole role;
    bool colored = false;  ///< its kernel differs between red, green and blue
};

/// Directions to the lights of one block, [light_block] each. Lights that fill up the last block are (0, 0, 0).
struct LightDirections {
    const float *x, *y, *z;
};

/// A point of a fibre as the eye sees it.
struct FiberView {
    Vec3d tangent, to_eye;
};

/// Kernels of one block: values[lobe][channel][light]. A lobe that is not colored fills channel 0 alone.
struct KernelBlock {
    alignas(64) float values[most_lobes][3][light_block];
};

/// Sine and cosine of an angle to the tangent.
struct TangentAngle {
    double sine, cosine;
};

// The lobes of a model with ZonalKernels.
inline constexpr int diffuse_lobe = 0, specular_lobe = 1;

/// The part of a zonal model that irradiance maps use. The model has two lobes: K of diffuse_lobe does not depend on
/// the view, and K of specular_lobe depends on theta_light + theta_view alone. Angles are to the tangent, in radians, 0
/// to pi.
class ZonalKernels {
public:
    virtual ~ZonalKernels() = default;

    /// K from angles, and from their sines and cosines; the two agree to rounding.
    virtual double kernel(int lobe, double theta_light, double theta_view) const = 0;
    virtual double kernel(int lobe, const TangentAngle& light, const TangentAngle& view) const = 0;

    /// Zonal coefficients lambda_l = 2 pi * integral over x = cos(theta_light) in [-1, 1] of K P_l(x), l = 0 .. bands -
    /// 1; `bands` is 1 to 128.
    virtual std::vector<double> coefficients(int lobe, int bands, double theta_view) const = 0;

    /// Integral of K^2 over the sphere; equals the sum over all l of lambda_l^2 (2 l + 1) / (4 pi).
    virtual double energy(int lobe, double theta_view) const = 0;

    /// Angle from the specular lobe's peak at which the lobe falls to one half, radians.
    virtual double half_width() const = 0;
};

class FiberModel {
public:
    virtual ~FiberModel() = default;

    /// 1 to most_lobes. The first lobe is the broadest: the arriving share of its light stands for transmittance.
    virtual std::span<const FiberLobe> lobes() const = 0;

    /// Whether every kernel depends on the angles to the tangent alone, not on the azimuth between light and eye.
    virtual bool is_zonal() const = 0;

    /// Whether every kernel stays the same when root and tip are swapped: K(-t, l, e) = K(t, l, e).
    virtual bool is_symmetric_root_tip() const = 0;

    /// Largest second derivative of a lobe by the light's angle, divided by the lobe's peak (1 / rad^2): p for cos^p,
    /// 1 / beta^2 for a Gaussian of standard deviation beta. It decides how finely lights and angles are sampled.
    virtual double sharpness() const = 0;

    /// Kernels of the lights of one block, in single precision. Finite for the direction (0, 0, 0) as well.
    virtual void evaluate(const LightDirections& lights, const FiberView& view, KernelBlock& kernels) const = 0;

    /// The zonal kernels that irradiance maps need; null for a model that has no maps yet. The render modes brute,
    /// reference and directional take such a model.
    virtual const ZonalKernels* zonal_kernels() const { return nullptr; }
};

/// The chosen model.
/// Throws Error(usage) naming the first of its parameters that is out of range (fiber_numbers).
std::unique_ptr<const FiberModel> make_fiber_model(const FiberSettings& settings);

/// The zonal kernels of `model`, which was made from `settings`.
/// Throws Error(usage) when this model has no maps. The message names the model and the models that have maps.
const ZonalKernels& zonal_kernels_for_maps(const FiberModel& model, const FiberSettings& settings);

}  // namespace hairbake
