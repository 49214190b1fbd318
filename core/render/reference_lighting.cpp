// The mode that knows everything: traced transmittance inside the sum over the lights.
#include <algorithm>
#include <utility>
#include <vector>

#include "core/base/random.h"
#include "core/render/fiber_lighting.h"
#include "core/render/pixel_samples.h"

namespace hairbake {
namespace {

double sum_of(const Vec3d& v) { return v.x + v.y + v.z; }

/// Energy that every light would send through one kernel if nothing hid it: what lights are drawn by.
class LightWeights {
public:
    explicit LightWeights(const LightSum& lights)
        : lights_(lights), weight_(lights.blocks() * light_block), block_(lights.blocks()) {}

    void set(std::size_t block, const float* kernel) {
        const float* energy = lights_.energy(block);
        float* weight = &weight_[block * light_block];
        for (std::size_t i = 0; i < light_block; ++i) weight[i] = kernel[i] * energy[i];
        block_[block] = lights_.energy(block, kernel);
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
    /// The light of the block at `rest` of its weight. Rounding may leave a rest: then the last light with weight.
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
    std::vector<float> weight_;
    std::vector<double> block_;
};

class ReferenceLighting : public FiberLighting {
public:
    ReferenceLighting(VertexRays rays, const VertexTransmittance& guess, const LightSum& lights, int light_samples)
        : rays_(std::move(rays)), guess_(guess), lights_(lights), light_samples_(light_samples) {}

    void light(std::span<const StrandPoint> points, std::span<FiberLight> result,
               const Progress& progress) const override {
        LightWeights diffuse(lights_), specular(lights_);
        KernelBlock kernels;
        for (std::size_t i = 0; i < points.size(); ++i) {
            progress.check();
            const StrandPoint& point = points[i];
            KernelSums unhidden;
            for (std::size_t b = 0; b < lights_.blocks(); ++b) {
                lights_.kernels(b, point.tangent, point.to_eye, kernels);
                lights_.add(b, kernels, nullptr, unhidden);
                diffuse.set(b, kernels.sine);
                specular.set(b, kernels.lobe);
            }
            // With another number of lights other lights are drawn, so that two pictures tell how large the noise is.
            Random random(sample_seed(point.seed, static_cast<std::uint64_t>(light_samples_), 0));
            const double guess = guess_.at(point.place);
            FiberLight& light = result[i];
            light.diffuse = arriving(diffuse, unhidden.diffuse, point, guess, random);
            light.specular = arriving(specular, unhidden.specular, point, guess, random);
            const double all = sum_of(unhidden.diffuse);
            light.transmittance = all > 0 ? sum_of(light.diffuse) / all : 1;
        }
    }

private:
    /// Estimates the sum of flux * kernel * T over the lights. A light drawn stands for its flux over its energy, a
    /// colour, times the total energy; that colour times `guess` is replaced by its known mean, the unhidden sum.
    Vec3d arriving(const LightWeights& weights, const Vec3d& unhidden, const StrandPoint& point, double guess,
                   Random& random) const {
        const double total = weights.total();
        if (!(total > 0)) return {};
        Vec3d sum;
        weights.draw(light_samples_, random, [&](std::size_t light) {
            const std::uint32_t vertex = point.place.vertex + (random.next() < point.place.u ? 1 : 0);
            const Vec3d flux(lights_.flux(light));
            const double t = double(rays_.transmittance(vertex, lights_.direction(light)));
            sum += flux * ((t - guess) / sum_of(flux));
        });
        return sum * (total / light_samples_) + unhidden * guess;
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
