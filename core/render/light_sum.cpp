#include "core/render/light_sum.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace hairbake {
namespace {

/// Sum of a * b over a block: sixteen sums side by side, so that the compiler needs no leave to reorder.
double dot_block(const float* a, const float* b) {
    constexpr std::size_t lanes = 16;
    std::array<float, lanes> sum{};
    for (std::size_t i = 0; i < light_block; i += lanes)
        for (std::size_t k = 0; k < lanes; ++k) sum[k] += a[i + k] * b[i + k];
    double total = 0;
    for (const float s : sum) total += double(s);
    return total;
}

}  // namespace

LightSum::LightSum(const LightSet& lights, double exponent) : count_(lights.size()), exponent_(exponent) {
    const std::size_t padded = (count_ + light_block - 1) / light_block * light_block;
    x_ = lights.x;
    y_ = lights.y;
    z_ = lights.z;
    for (std::vector<float>* v : {&x_, &y_, &z_, &red_, &green_, &blue_, &energy_}) v->resize(padded, 0.0f);
    for (std::size_t i = 0; i < count_; ++i) {
        red_[i] = lights.flux[4 * i];
        green_[i] = lights.flux[4 * i + 1];
        blue_[i] = lights.flux[4 * i + 2];
        energy_[i] = red_[i] + green_[i] + blue_[i];
    }
    whole_ = exponent >= 1 && exponent == std::floor(exponent);
    cut_ = exponent > 0 ? static_cast<float>(std::exp(std::log(1e-12) / std::max(exponent, 0.5))) : 0;
}

/// power = base^exponent, base in {0} and [cut, 1]; base is used up. The cut keeps every square a normal number.
void LightSum::raise(float* base, float* power) const {
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

void LightSum::kernels(std::size_t block, const Vec3d& tangent, const Vec3d& to_eye, KernelBlock& out) const {
    const float *x = &x_[block * light_block], *y = &y_[block * light_block], *z = &z_[block * light_block];
    const Vec3f t(tangent);
    const auto eye_cosine = static_cast<float>(dot(tangent, to_eye));
    const auto eye_sine = static_cast<float>(length(cross(tangent, to_eye)));
    alignas(64) float base[light_block];
    for (std::size_t i = 0; i < light_block; ++i) {
        const float cx = t.y * z[i] - t.z * y[i], cy = t.z * x[i] - t.x * z[i], cz = t.x * y[i] - t.y * x[i];
        const float sine = std::sqrt(cx * cx + cy * cy + cz * cz);
        const float cosine = sine * eye_sine - (t.x * x[i] + t.y * y[i] + t.z * z[i]) * eye_cosine;
        out.sine[i] = sine;
        base[i] = cosine > cut_ ? std::min(cosine, 1.0f) : 0.0f;
    }
    raise(base, out.lobe);
}

void LightSum::add(std::size_t block, const KernelBlock& kernels, const float* transmittance, KernelSums& sums) const {
    const std::size_t first = block * light_block;
    const float *diffuse = kernels.sine, *specular = kernels.lobe;
    alignas(64) float seen[2][light_block];
    if (transmittance) {
        for (std::size_t i = 0; i < light_block; ++i) {
            seen[0][i] = kernels.sine[i] * transmittance[i];
            seen[1][i] = kernels.lobe[i] * transmittance[i];
        }
        diffuse = seen[0];
        specular = seen[1];
    }
    const float *red = &red_[first], *green = &green_[first], *blue = &blue_[first];
    sums.diffuse += {dot_block(red, diffuse), dot_block(green, diffuse), dot_block(blue, diffuse)};
    sums.specular += {dot_block(red, specular), dot_block(green, specular), dot_block(blue, specular)};
}

double LightSum::energy(std::size_t block, const float* kernel) const { return dot_block(energy(block), kernel); }

KernelSums LightSum::sum(const Vec3d& tangent, const Vec3d& to_eye) const {
    KernelSums sums;
    KernelBlock block;
    for (std::size_t b = 0; b < blocks(); ++b) {
        kernels(b, tangent, to_eye, block);
        add(b, block, nullptr, sums);
    }
    return sums;
}

Vec3d LightSum::irradiance(const Vec3d& normal) const {
    const Vec3f n(normal);
    Vec3d sum;
    for (std::size_t b = 0; b < blocks(); ++b) {
        const std::size_t first = b * light_block;
        alignas(64) float cosine[light_block];
        for (std::size_t i = 0; i < light_block; ++i)
            cosine[i] = std::max(0.0f, n.x * x_[first + i] + n.y * y_[first + i] + n.z * z_[first + i]);
        sum += {dot_block(&red_[first], cosine), dot_block(&green_[first], cosine), dot_block(&blue_[first], cosine)};
    }
    return sum;
}

}  // namespace hairbake
