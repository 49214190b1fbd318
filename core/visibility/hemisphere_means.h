// What a surface point sees: means of the transmittance over the hemisphere about its normal.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/base/vec.h"

namespace hairbake {

/// Sums of one point over the directions w_k above its plane (n . w_k > 0), and what they make.
struct HemisphereSums {
    double t = 0, t_cosine = 0;     ///< of T and of T (n . w)
    double weight = 0, cosine = 0;  ///< of 1 and of n . w: the same additions with T = 1

    void add(double transmittance, double n_dot_w) {
        if (!(n_dot_w > 0)) return;
        t += transmittance;
        t_cosine += transmittance * n_dot_w;
        weight += 1;
        cosine += n_dot_w;
    }
    /// Mean of T over the hemisphere, plain and cosine-weighted, each divided by the sum of the weights that were used:
    /// exactly 1 where nothing is blocked, whatever the directions. Without a direction above the plane (sets of a few
    /// directions) nothing is known to be blocked: 1.
    std::array<float, 2> means() const {
        return {weight > 0 ? static_cast<float>(t / weight) : 1.0f,
                cosine > 0 ? static_cast<float>(t_cosine / cosine) : 1.0f};
    }
};

}  // namespace hairbake
