// The mode with a baked directional transmittance.
#include <algorithm>
#include <array>

#include "core/base/assert.h"
#include "core/base/spherical_harmonics.h"
#include "core/render/fiber_lighting.h"

namespace hairbake {
namespace {

constexpr int most_coefficients = 16;
using Seen = std::array<float, light_block>;

double sum_of(const Vec3d& v) { return v.x + v.y + v.z; }

/// Sums over all lights; seen_by(block, seen) fills in T of a block's lights.
template <class SeenBy>
FiberLight sum_seen(const LightSum& lights, const StrandPoint& point, const SeenBy& seen_by) {
    LobeSums sums;
    double unblocked = 0;  // through the first lobe
    KernelBlock kernels;
    alignas(64) Seen seen;
    for (std::size_t b = 0; b < lights.blocks(); ++b) {
        lights.evaluate(b, point.view, kernels);
        seen_by(b, seen);
        lights.add(b, kernels, seen.data(), sums);
        unblocked += lights.energy(b, kernels, 0);
    }
    return {unblocked > 0 ? sum_of(sums[0]) / unblocked : 1, sums};
}

class ShLighting : public FiberLighting {
public:
    ShLighting(const DirectionalTransmittance& transmittance, const LightSum& lights)
        : transmittance_(transmittance), lights_(lights), count_(transmittance.sh_bands * transmittance.sh_bands) {
        // Harmonics of every light: [block][coefficient][light].
        const ShBasis basis(transmittance.sh_bands);
        harmonics_.assign(lights.blocks() * light_block * count_, 0.0f);
        std::vector<double> values(count_);
        for (std::size_t i = 0; i < lights.lights(); ++i) {
            basis.evaluate(lights.direction(i), values);
            for (std::size_t c = 0; c < count_; ++c)
                harmonics_[(i / light_block * count_ + c) * light_block + i % light_block] = float(values[c]);
        }
    }

    void light(std::span<const StrandPoint> points, std::span<FiberLight> result,
               const Progress& progress) const override {
        for (std::size_t i = 0; i < points.size(); ++i) {
            progress.check();
            const std::array<float, most_coefficients> coefficients = coefficients_at(points[i].place);
            result[i] = sum_seen(lights_, points[i], [&](std::size_t b, Seen& seen) {
                seen.fill(0);
                for (std::size_t c = 0; c < count_; ++c) {
                    const float* harmonic = &harmonics_[(b * count_ + c) * light_block];
                    for (std::size_t k = 0; k < light_block; ++k) seen[k] += coefficients[c] * harmonic[k];
                }
                for (float& t : seen) t = std::clamp(t, 0.0f, 1.0f);
            });
        }
    }

private:
    std::array<float, most_coefficients> coefficients_at(const StrandPlace& place) const {
        const float* at = transmittance_.sh.data() + place.vertex * count_;
        std::array<float, most_coefficients> coefficients{};
        for (std::size_t c = 0; c < count_; ++c)
            coefficients[c] = float((1 - place.u) * double(at[c]) + place.u * double(at[c + count_]));
        return coefficients;
    }

    const DirectionalTransmittance& transmittance_;
    const LightSum& lights_;
    std::size_t count_;
    std::vector<float> harmonics_;
};

class ConeLighting : public FiberLighting {
public:
    ConeLighting(const DirectionalTransmittance& transmittance, const LightSum& lights)
        : transmittance_(transmittance), lights_(lights) {}

    void light(std::span<const StrandPoint> points, std::span<FiberLight> result,
               const Progress& progress) const override {
        for (std::size_t i = 0; i < points.size(); ++i) {
            progress.check();
            const BentCone cone = cone_at(points[i].place);
            result[i] = sum_seen(lights_, points[i], [&](std::size_t b, Seen& seen) {
                for (std::size_t k = 0; k < light_block; ++k)
                    seen[k] = static_cast<float>(cone.at(lights_.direction(b * light_block + k)));
            });
        }
    }

private:
    BentCone cone_at(const StrandPlace& place) const {
        double average = 0;
        Vec3d moment;
        for (const int end : {0, 1}) {
            const double share = end == 0 ? 1 - place.u : place.u, a = transmittance_.average[place.vertex + end];
            const float* cone = &transmittance_.bent_cone[4 * (std::size_t(place.vertex) + end)];
            average += share * a;
            moment += BentCone::moment(a, Vec3d(cone[0], cone[1], cone[2]), cone[3]) * share;
        }
        return {average, moment};
    }

    const DirectionalTransmittance& transmittance_;
    const LightSum& lights_;
};

}  // namespace

std::unique_ptr<FiberLighting> directional_lighting(const DirectionalTransmittance& transmittance,
                                                    const LightSum& lights) {
    HAIRBAKE_ASSERT(transmittance.sh.empty() != transmittance.bent_cone.empty() && transmittance.sh_bands <= 4);
    if (transmittance.sh_bands > 0) return std::make_unique<ShLighting>(transmittance, lights);
    return std::make_unique<ConeLighting>(transmittance, lights);
}

}  // namespace hairbake
