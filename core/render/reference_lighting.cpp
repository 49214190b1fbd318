// The mode with the traced transmittance inside the sum over the lights.
#include <algorithm>
#include <utility>
#include <vector>

#include "core/base/random.h"
#include "core/render/fiber_lighting.h"
#include "core/render/pixel_samples.h"

namespace hairbake {
namespace {

double sum_of(const Vec3d& v) { return v.x + v.y + v.z; }

/// The energy that every light would send through one lobe if nothing blocked it. Lights are drawn in proportion to
/// this energy.
class LightWeights {
public:
    LightWeights(const LightSum& lights, std::size_t lobe)
        : lights_(lights),
          lobe_(lobe),
          colored_(lights.lobes()[lobe].colored),
          weight_(lights.blocks() * light_block),
          block_(lights.blocks()) {
        if (colored_) kernel_.resize(weight_.size());
    }

    void set(std::size_t block, const KernelBlock& kernels) {
        const std::size_t first = block * light_block;
        lights_.energies(block, kernels, lobe_, &weight_[first]);
        block_[block] = lights_.energy(block, kernels, lobe_);
        if (!colored_) return;
        const auto& kernel = kernels.values[lobe_];
        for (std::size_t i = 0; i < light_block; ++i) kernel_[first + i] = {kernel[0][i], kernel[1][i], kernel[2][i]};
    }

    /// The color of the light that arrives from `light` through the lobe, in any unit but not 0.
    Vec3d color(std::size_t light) const {
        const Vec3d flux(lights_.flux(light));
        return colored_ ? flux * Vec3d(kernel_[light]) : flux;
    }

    double total() const {
        double sum = 0;
        for (const double block : block_) sum += block;
        return sum;
    }

    /// Calls visit(light) for `count` lights drawn with probability weight / total: the k-th falls into the k-th of
    /// `count` equal parts of the total. The total is above 0.
    template <class Visit>
    void draw(int count, Random& random, const Visit& visit) const {
        const double all = total();
        std::size_t block = 0;
        double before = 0;  // weight of all blocks before this one
        for (int k = 0; k < count; ++k) {
            const double at = (k + random.next()) / count * all;
            while (block + 1 < block_.size() && before + block_[block] <= at) before += block_[block++];
            visit(find(block, at - before));
        }
    }

private:
    /// The light of the block where the sum of the weights passes `rest`. Where rounding leaves a rest, the last light
    /// with a weight.
    std::size_t find(std::size_t block, double rest) const {
        const float* weight = &weight_[block * light_block];
        std::size_t last = 0;
        for (std::size_t i = 0; i < light_block; ++i) {
            if (!(weight[i] > 0)) continue;
            last = i;
            if (rest < double(weight[i])) break;
            rest -= double(weight[i]);
        }
        return block * light_block + last;
    }

    const LightSum& lights_;
    std::size_t lobe_;
    bool colored_;
    std::vector<float> weight_;
    std::vector<double> block_;
    std::vector<Vec3f> kernel_;  // of a colored lobe
};

class ReferenceLighting : public FiberLighting {
public:
    ReferenceLighting(VertexRays rays, const VertexTransmittance& guess, const LightSum& lights, int light_samples)
        : rays_(std::move(rays)), guess_(guess), lights_(lights), light_samples_(light_samples) {}

    void light(std::span<const StrandPoint> points, std::span<FiberLight> result,
               const Progress& progress) const override {
        std::vector<LightWeights> weights;
        for (std::size_t lobe = 0; lobe < lights_.lobes().size(); ++lobe) weights.emplace_back(lights_, lobe);
        KernelBlock kernels;
        for (std::size_t i = 0; i < points.size(); ++i) {
            progress.check();
            const StrandPoint& point = points[i];
            LobeSums unblocked;
            for (std::size_t b = 0; b < lights_.blocks(); ++b) {
                lights_.evaluate(b, point.view, kernels);
                lights_.add(b, kernels, nullptr, unblocked);
                for (LightWeights& lobe : weights) lobe.set(b, kernels);
            }
            // Another number of lights draws other lights, so that the difference of two pictures shows the noise.
            Random random(sample_seed(point.seed, static_cast<std::uint64_t>(light_samples_), 0));
            const double guess = guess_.at(point.place);
            result[i] = {};
            for (std::size_t lobe = 0; lobe < weights.size(); ++lobe)
                result[i].lobes[lobe] = arriving(weights[lobe], unblocked[lobe], point, guess, random);
            const double all = sum_of(unblocked[0]);
            result[i].transmittance = all > 0 ? sum_of(result[i].lobes[0]) / all : 1;
        }
    }

private:
    /// Estimates the sum of flux * kernel * T over the lights. A drawn light counts with its color divided by its
    /// energy, times the total energy. Of T, only the difference from `guess` is sampled; the sum with T = guess is
    /// known: guess times the unblocked sum.
    Vec3d arriving(const LightWeights& weights, const Vec3d& unblocked, const StrandPoint& point, double guess,
                   Random& random) const {
        const double total = weights.total();
        if (!(total > 0)) return {};
        Vec3d sum;
        weights.draw(light_samples_, random, [&](std::size_t light) {
            const std::uint32_t vertex = point.place.vertex + (random.next() < point.place.u ? 1 : 0);
            const Vec3d color = weights.color(light);
            const double t = double(rays_.transmittance(vertex, lights_.direction(light)));
            sum += color * ((t - guess) / sum_of(color));
        });
        return sum * (total / light_samples_) + unblocked * guess;
    }

    VertexRays rays_;
    const VertexTransmittance& guess_;
    const LightSum& lights_;
    int light_samples_;
};

}  // namespace

std::unique_ptr<FiberLighting> reference_lighting(VertexRays rays, const VertexTransmittance& guess,
                                                  const LightSum& lights, int light_samples) {
    return std::make_unique<ReferenceLighting>(std::move(rays), guess, lights, light_samples);
}

}  // namespace hairbake
