#include "core/render/light_sum.h"

#include <algorithm>

#include "core/base/assert.h"

namespace hairbake {
namespace {

/// Sum of a * b over a block: sixteen sums side by side, so that the compiler may vectorise without reordering a sum.
double dot_block(const float* a, const float* b) {
    constexpr std::size_t lanes = 16;
    std::array<float, lanes> sum{};
    for (std::size_t i = 0; i < light_block; i += lanes)
        for (std::size_t k = 0; k < lanes; ++k) sum[k] += a[i + k] * b[i + k];
    double total = 0;
    for (const float s : sum) total += double(s);
    return total;
}

/// The kernel of one channel; a lobe without color has one kernel for all three.
const float* kernel_of(const KernelBlock& kernels, const FiberLobe& lobe, std::size_t index, int channel) {
    return kernels.values[index][lobe.colored ? channel : 0];
}

}  // namespace

LightSum::LightSum(const LightSet& lights, const FiberModel& model)
    : model_(model), lobes_(model.lobes()), count_(lights.size()) {
    HAIRBAKE_ASSERT(!lobes_.empty() && lobes_.size() <= most_lobes);
    const std::size_t padded = (count_ + light_block - 1) / light_block * light_block;
    x_ = lights.x;
    y_ = lights.y;
    z_ = lights.z;
    for (std::vector<float>* v : {&x_, &y_, &z_, &red_, &green_, &blue_, &all_}) v->resize(padded, 0.0f);
    for (std::size_t i = 0; i < count_; ++i) {
        red_[i] = lights.flux[4 * i];
        green_[i] = lights.flux[4 * i + 1];
        blue_[i] = lights.flux[4 * i + 2];
        all_[i] = red_[i] + green_[i] + blue_[i];
    }
}

void LightSum::evaluate(std::size_t block, const FiberView& view, KernelBlock& kernels) const {
    const std::size_t first = block * light_block;
    model_.evaluate({&x_[first], &y_[first], &z_[first]}, view, kernels);
}

void LightSum::add(std::size_t block, const KernelBlock& kernels, const float* transmittance, LobeSums& sums) const {
    const std::size_t first = block * light_block;
    const std::array<const float*, 3> flux{&red_[first], &green_[first], &blue_[first]};
    alignas(64) float seen[light_block];
    for (std::size_t k = 0; k < lobes_.size(); ++k) {
        Vec3d sum;
        const float* kernel = nullptr;
        for (int channel = 0; channel < 3; ++channel) {
            if (channel == 0 || lobes_[k].colored) {
                kernel = kernel_of(kernels, lobes_[k], k, channel);
                if (transmittance) {
                    for (std::size_t i = 0; i < light_block; ++i) seen[i] = kernel[i] * transmittance[i];
                    kernel = seen;
                }
            }
            sum[channel] = dot_block(flux[channel], kernel);
        }
        sums[k] += sum;
    }
}

void LightSum::energies(std::size_t block, const KernelBlock& kernels, std::size_t lobe, float* energy) const {
    const std::size_t first = block * light_block;
    if (!lobes_[lobe].colored) {
        const float* kernel = kernels.values[lobe][0];
        for (std::size_t i = 0; i < light_block; ++i) energy[i] = kernel[i] * all_[first + i];
        return;
    }
    const auto& kernel = kernels.values[lobe];
    for (std::size_t i = 0; i < light_block; ++i)
        energy[i] = kernel[0][i] * red_[first + i] + kernel[1][i] * green_[first + i] + kernel[2][i] * blue_[first + i];
}

double LightSum::energy(std::size_t block, const KernelBlock& kernels, std::size_t lobe) const {
    const std::size_t first = block * light_block;
    const auto& kernel = kernels.values[lobe];
    if (!lobes_[lobe].colored) return dot_block(&all_[first], kernel[0]);
    return dot_block(&red_[first], kernel[0]) + dot_block(&green_[first], kernel[1]) +
           dot_block(&blue_[first], kernel[2]);
}

LobeSums LightSum::sum(const FiberView& view) const {
    LobeSums sums;
    KernelBlock kernels;
    for (std::size_t b = 0; b < blocks(); ++b) {
        evaluate(b, view, kernels);
        add(b, kernels, nullptr, sums);
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
