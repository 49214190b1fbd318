#include "core/fiber/kajiya_kay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/assert.h"
#include "core/base/gauss_legendre.h"
#include "core/fiber/fiber_model.h"

namespace hairbake {

using std::numbers::pi;

double clamped_power(double cosine, double exponent) {
    if (cosine <= 0) return 0;
    return exponent == 0 ? 1 : std::pow(cosine, exponent);
}

double kajiya_kay_diffuse(const Vec3d& tangent, const Vec3d& to_light) { return length(cross(tangent, to_light)); }

double kajiya_kay_specular(const Vec3d& tangent, const Vec3d& to_light, const Vec3d& to_eye, double exponent) {
    const double sines = length(cross(tangent, to_light)) * length(cross(tangent, to_eye));
    return clamped_power(sines - dot(tangent, to_light) * dot(tangent, to_eye), exponent);
}

double kajiya_kay_specular(double theta_light, double theta_view, double exponent) {
    return clamped_power(-std::cos(theta_light + theta_view), exponent);
}

std::vector<double> diffuse_zonal(int bands) {
    std::vector<double> lambda(bands, 0.0);
    double value = pi * pi;
    for (int l = 0; l < bands; l += 2) {
        if (l > 0) value *= double(l - 3) * (l - 1) / (double(l) * (l + 2));
        lambda[l] = value;
    }
    return lambda;
}

std::vector<double> specular_zonal(int bands, double exponent, double theta_view) {
    HAIRBAKE_ASSERT(bands >= 1 && bands <= 128 && exponent >= 0 && exponent <= 8192);
    // u = pi - theta - theta_view is the angle from the lobe's peak; beyond `reach` the kernel is below 1e-20.
    const double reach = exponent > 0 ? std::acos(std::exp(-46 / std::max(exponent, 1e-3))) : pi / 2;
    const double low = std::max(0.0, pi - theta_view - reach), high = std::min(pi, pi - theta_view + reach);
    std::vector<double> lambda(bands, 0.0);
    if (high <= low) return lambda;
    const Quadrature rule = gauss_legendre(256);
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const double theta = 0.5 * (low + high) + 0.5 * (high - low) * rule.nodes[i];
        const double weight =
            pi * (high - low) * rule.weights[i] * std::sin(theta) * kajiya_kay_specular(theta, theta_view, exponent);
        const double x = std::cos(theta);
        double previous = 0, legendre = 1;
        for (int l = 0; l < bands; ++l) {
            lambda[l] += weight * legendre;
            const double next = ((2 * l + 1) * x * legendre - l * previous) / (l + 1);
            previous = legendre;
            legendre = next;
        }
    }
    return lambda;
}

double diffuse_energy() { return 8 * pi / 3; }

double specular_energy(double exponent, double theta_view) { return specular_zonal(1, 2 * exponent, theta_view)[0]; }

namespace {

constexpr std::array<FiberLobe, 2> kajiya_kay_lobes{
    {{"diffuse", LobeRole::diffuse, false}, {"specular", LobeRole::specular, false}}};
constexpr double negligible = 1e-12;  // of the specular lobe's peak: too little for sums in single precision

class KajiyaKay final : public FiberModel, public ZonalKernels {
public:
    explicit KajiyaKay(double exponent)
        : exponent_(exponent),
          cut_(exponent > 0 ? static_cast<float>(std::exp(std::log(negligible) / std::max(exponent, 0.5))) : 0),
          whole_(exponent >= 1 && exponent == std::floor(exponent)) {}

    std::span<const FiberLobe> lobes() const override { return kajiya_kay_lobes; }
    bool is_zonal() const override { return true; }
    bool is_symmetric_root_tip() const override { return true; }
    double sharpness() const override { return exponent_; }
    const ZonalKernels* zonal_kernels() const override { return this; }

    void evaluate(const LightDirections& lights, const FiberView& view, KernelBlock& kernels) const override {
        const float *x = lights.x, *y = lights.y, *z = lights.z;
        float *sines = kernels.values[diffuse_lobe][0], *lobe = kernels.values[specular_lobe][0];
        const Vec3f t(view.tangent);
        const auto eye_cosine = static_cast<float>(dot(view.tangent, view.to_eye));
        const auto eye_sine = static_cast<float>(length(cross(view.tangent, view.to_eye)));
        alignas(64) float base[light_block];
        for (std::size_t i = 0; i < light_block; ++i) {
            const float cx = t.y * z[i] - t.z * y[i], cy = t.z * x[i] - t.x * z[i], cz = t.x * y[i] - t.y * x[i];
            const float sine = std::sqrt(cx * cx + cy * cy + cz * cz);
            const float cosine = sine * eye_sine - (t.x * x[i] + t.y * y[i] + t.z * z[i]) * eye_cosine;
            sines[i] = sine;
            base[i] = cosine > cut_ ? std::min(cosine, 1.0f) : 0.0f;
        }
        raise(base, lobe);
    }

    double kernel(int lobe, double theta_light, double theta_view) const override {
        return lobe == diffuse_lobe ? std::sin(theta_light) : kajiya_kay_specular(theta_light, theta_view, exponent_);
    }

    double kernel(int lobe, const TangentAngle& light, const TangentAngle& view) const override {
        if (lobe == diffuse_lobe) return light.sine;
        return clamped_power(light.sine * view.sine - light.cosine * view.cosine, exponent_);
    }

    std::vector<double> coefficients(int lobe, int bands, double theta_view) const override {
        return lobe == diffuse_lobe ? diffuse_zonal(bands) : specular_zonal(bands, exponent_, theta_view);
    }

    double energy(int lobe, double theta_view) const override {
        return lobe == diffuse_lobe ? diffuse_energy() : specular_energy(exponent_, theta_view);
    }

    /// cos^p is one half at acos(2^(-1/p)).
    double half_width() const override {
        return exponent_ > 0 ? std::acos(std::exp2(-1 / std::max(exponent_, 1.0))) : pi / 2;
    }

private:
    /// power = base^exponent, base in {0} and [cut, 1]; `base` is overwritten. The cut keeps every square a normal
    /// number.
    void raise(float* base, float* power) const {
        if (!whole_) {
            const auto p = static_cast<float>(exponent_);
            for (std::size_t i = 0; i < light_block; ++i) power[i] = base[i] > 0 ? std::pow(base[i], p) : 0.0f;
            return;
        }
        auto left = static_cast<unsigned>(exponent_);
        std::fill_n(power, light_block, 1.0f);
        for (;; left >>= 1) {
            if (left & 1)
                for (std::size_t i = 0; i < light_block; ++i) power[i] *= base[i];
            if (left <= 1) return;
            for (std::size_t i = 0; i < light_block; ++i) base[i] *= base[i];
        }
    }

    double exponent_;
    float cut_;   // a cosine below this gives less than `negligible`
    bool whole_;  // the exponent is an integer
};

}  // namespace

std::unique_ptr<const FiberModel> make_fiber_model(const KajiyaKayParameters& parameters) {
    return std::make_unique<KajiyaKay>(parameters.exponent);
}

}  // namespace hairbake
