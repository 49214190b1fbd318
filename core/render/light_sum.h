// The sum over every light with the exact kernels of a fibre model, for one point of a strand.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/base/vec.h"
#include "core/environment/light_set.h"
#include "core/fiber/fiber_model.h"

namespace hairbake {

/// For each lobe the sum over lights of flux times kernel: radiance times steradian, Kd and Ks not applied.
using LobeSums = std::array<Vec3d, most_lobes>;

/// The lights of an environment in blocks of light_block; the last block is filled up with lights of no flux.
///
/// Sums are in single precision, with an error of about 1e-5 of the sum. The lights are those of the exact maps: texels
/// gathered at flux centroids (light_set.h). Their sum agrees with the sum over every pixel to 0.05 % of the largest
/// value, and one picture point needs thousands of lights instead of millions of pixels. Refers to the model, which
/// must outlive it. Immutable after construction: thread-safe.
class LightSum {
public:
    LightSum(const LightSet& lights, const FiberModel& model);

    std::span<const FiberLobe> lobes() const { return lobes_; }
    std::size_t blocks() const { return x_.size() / light_block; }
    std::size_t lights() const { return count_; }
    Vec3d direction(std::size_t light) const { return {x_[light], y_[light], z_[light]}; }
    Vec3f flux(std::size_t light) const { return {red_[light], green_[light], blue_[light]}; }

    /// Kernels of one block's lights.
    void evaluate(std::size_t block, const FiberView& view, KernelBlock& kernels) const;

    /// Adds flux times kernel of one block, multiplied by `transmittance` ([light_block]) unless that is null.
    void add(std::size_t block, const KernelBlock& kernels, const float* transmittance, LobeSums& sums) const;

    /// Energy of each light of one block through one lobe: the sum over red, green and blue of flux times kernel;
    /// [light_block]. And the sum of these energies.
    void energies(std::size_t block, const KernelBlock& kernels, std::size_t lobe, float* energy) const;
    double energy(std::size_t block, const KernelBlock& kernels, std::size_t lobe) const;

    /// Over all lights.
    LobeSums sum(const FiberView& view) const;

    /// Irradiance of a surface: the sum of flux * max(0, cosine) over all lights.
    Vec3d irradiance(const Vec3d& normal) const;

private:
    const FiberModel& model_;
    std::span<const FiberLobe> lobes_;
    std::size_t count_;
    std::vector<float> x_, y_, z_, red_, green_, blue_;
    std::vector<float> all_;  // red + green + blue
};

}  // namespace hairbake
