// Mean, spherical harmonics and bent cone of the transmittance T over a set of directions: the definitions that all
// methods share (docs/math.md, "Directional means").
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/base/vec.h"

namespace hairbake {

/// The weights of moments. A moment is a sum over the directions w_k of T_k times a weight: 1, x, y, z, Y_4(w) ..
/// Y_15(w). (The first four give the harmonics Y_0 .. Y_3, which are constants times 1, y, z, x, and the bent cone.)
class DirectionMoments {
public:
    /// sh_bands: 0 to 4. Without bands and cone the only moment is the mean.
    DirectionMoments(std::span<const Vec3d> directions, int sh_bands, bool bent_cone);

    std::size_t directions() const { return directions_; }
    /// 1, 4, 9 or 16.
    std::size_t count() const { return count_; }
    /// Weights of direction k, [count()], each of magnitude at most 1.
    std::span<const double> weights(std::size_t k) const { return {weights_.data() + k * count_, count_}; }

    /// Number of moments that `sh_bands` and `bent_cone` need.
    static std::size_t count_for(int sh_bands, bool bent_cone);

private:
    std::size_t directions_, count_;
    std::vector<double> weights_;
};

/// Coefficients c_i = (4 pi / N) sum over k of T_k Y_i(w_k) in the order l * l + l + m (z polar, no Condon-Shortley
/// phase); c_0 = 2 sqrt(pi) A.
///
/// moments: means over the N directions of T times each weight of DirectionMoments, at least as many as coefficients
/// sh:      the result; its size is 1, 4, 9 or 16
void sh_of_moments(std::span<const float> moments, std::span<float> sh);

/// Axis and half-angle (radians) of the bent cone (Klehm 2011): b = sum T w / sum T, axis b / |b|, half-angle
/// acos(2 |b| - 1).
///
/// average:  A, mean of T
/// mean_t_w: mean of T w
///
/// (0, 0, 0), pi where nothing is blocked (A >= 1 - 2^-20): the mean of the direction set itself is not exactly zero,
/// and it must not give an axis. (0, 0, 0), 0 where everything is blocked (A = 0). Where T is the same in all
/// directions but below 1, rounding errors and the direction set decide the axis, and the half-angle is nearly pi.
std::array<float, 4> bent_cone_of_moments(float average, const Vec3f& mean_t_w);

/// The means of P points.
struct DirectionalMeans {
    std::vector<float> average;    ///< [P], mean of T
    std::vector<float> sh;         ///< [P * bands^2]
    std::vector<float> bent_cone;  ///< [P * 4]
};

/// Adds up T of a number of points, direction by direction. Sums are doubles: the same bits when each point gets its
/// directions in the same order. Several threads may call add() for different points.
class DirectionalSums {
public:
    DirectionalSums(std::size_t points, std::span<const Vec3d> directions, int sh_bands, bool bent_cone);

    /// T of direction number `direction` at `point`.
    void add(std::size_t point, std::size_t direction, double t) {
        const std::span<const double> weights = moments_.weights(direction);
        double* sum = &sums_[point * moments_.count()];
        for (std::size_t i = 0; i < weights.size(); ++i) sum[i] += t * weights[i];
    }
    DirectionalMeans means() const;

private:
    DirectionMoments moments_;
    int sh_bands_;
    bool bent_cone_;
    std::vector<double> sums_;  ///< [P * moments]
};

}  // namespace hairbake
