// The sum over every light with the exact kernels, for one point of a strand.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/vec.h"
#include "core/environment/light_set.h"

namespace hairbake {

/// Sums of flux times kernel over lights.
struct KernelSums {
    Vec3d diffuse, specular;
};

/// Kernels of the lights of one block; the last block is filled up with lights of no flux.
constexpr std::size_t light_block = 256;
struct KernelBlock {
    alignas(64) float sine[light_block];  ///< |t x l|
    alignas(64) float lobe[light_block];  ///< max(0, sin sin - cos cos)^p; below 1e-12 it is 0
};

/// Kajiya and Kay's kernels (core/fiber) over a set of lights, 256 at a time and in single precision, which errs by
/// about 1e-5 of the sum. The lights are those of the exact maps: texels of the environment gathered at flux centroids
/// (light_set.h), which agree with the sum over every pixel to 0.05 % of the largest value (README): thousands of
/// pixels under one picture point are then as good as millions. Immutable after construction: thread-safe.
class LightSum {
public:
    LightSum(const LightSet& lights, double exponent);

    std::size_t blocks() const { return x_.size() / light_block; }
    std::size_t lights() const { return count_; }
    Vec3d direction(std::size_t light) const { return {x_[light], y_[light], z_[light]}; }
    Vec3f flux(std::size_t light) const { return {red_[light], green_[light], blue_[light]}; }
    /// Red plus green plus blue of a block's lights, [light_block]; and the sum of it times `kernel` ([light_block]).
    const float* energy(std::size_t block) const { return energy_.data() + block * light_block; }
    double energy(std::size_t block, const float* kernel) const;

    void kernels(std::size_t block, const Vec3d& tangent, const Vec3d& to_eye, KernelBlock& out) const;
    /// Adds flux times kernel of one block; with `transmittance` ([light_block]) times that too.
    void add(std::size_t block, const KernelBlock& kernels, const float* transmittance, KernelSums& sums) const;

    /// Over all lights.
    KernelSums sum(const Vec3d& tangent, const Vec3d& to_eye) const;

    /// Irradiance of a surface: sum of flux * max(0, cosine) over all lights.
    Vec3d irradiance(const Vec3d& normal) const;

private:
    void raise(float* base, float* power) const;

    std::size_t count_;
    double exponent_;
    float cut_;           // a cosine below this gives less than 1e-12
    bool whole_ = false;  // the exponent is an integer
    std::vector<float> x_, y_, z_, red_, green_, blue_, energy_;
};

}  // namespace hairbake
