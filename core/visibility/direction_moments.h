// What is kept of the transmittance T over a set of directions beside its mean: spherical harmonics and bent cones. One
// definition for every method.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/base/vec.h"

namespace hairbake {

/// The moments that an answer needs: sums over directions w_k of T_k times 1, x, y, z, Y_4(w) .. Y_15(w). (The first
/// four stand for the harmonics Y_0 .. Y_3 = 1, y, z, x times constants, and for the bent cone.)
class DirectionMoments {
public:
    /// `sh_bands` in [0, 4]. Without bands and cone the only moment is the mean.
    DirectionMoments(std::span<const Vec3d> directions, int sh_bands, bool bent_cone);

    std::size_t directions() const { return directions_; }
    /// 1, 4, 9 or 16.
    std::size_t count() const { return count_; }
    /// Weights of direction k, [count()], each of magnitude at most 1.
    std::span<const double> weights(std::size_t k) const { return {weights_.data() + k * count_, count_}; }

    /// How many moments `sh_bands` and `bent_cone` need.
    static std::size_t count_for(int sh_bands, bool bent_cone);

private:
    std::size_t directions_, count_;
    std::vector<double> weights_;
};

/// Coefficients c_i = (4 pi / N) sum over k of T_k Y_i(w_k), [sh.size()] = 1, 4, 9 or 16, in the order l * l + l + m (z
/// polar, no Condon-Shortley phase), from the means over the N directions of T times each weight ("moments", as many at
/// least; the first is A). c_0 = 2 sqrt(pi) A.
void sh_of_moments(std::span<const float> moments, std::span<float> sh);

/// Axis and half-angle of the bent cone (spec, section 10; Klehm 2011): b = sum T w / sum T, axis b / |b|, half-angle
/// acos(2 |b| - 1), from A = mean of T and the mean of T w. Where nothing is blocked, A >= 1 - 2^-20, it is (0, 0, 0),
/// pi; what a direction set's own mean, which is not exactly zero, would say does not count then. Where everything is
/// (A = 0), (0, 0, 0), 0. Where T is the same in all directions but not 1, the axis is that of rounding errors and of
/// the direction set, and the half-angle nearly pi.
std::array<float, 4> bent_cone_of_moments(float average, const Vec3f& mean_t_w);

/// The answers for a number of points.
struct DirectionalMeans {
    std::vector<float> average;    ///< [P], mean of T
    std::vector<float> sh;         ///< [P * bands^2]
    std::vector<float> bent_cone;  ///< [P * 4]
};

/// Sums up T of a number of points, direction by direction, and answers. Doubles; the same bits whenever each point
/// gets its directions in the same order. add() may be called from several threads for different points.
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
