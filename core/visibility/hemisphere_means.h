// Means of the transmittance over the hemisphere about a surface point's normal (docs/math.md, "The receiver").
#pragma once

#include <array>

namespace hairbake {

/// Sums of one point over the directions w_k above its plane (n . w_k > 0), and their means.
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
    /// Mean of T over the hemisphere, plain and cosine-weighted. Each is divided by the sum of its weights, so that it
    /// is exactly 1 where nothing is blocked, for any directions. 1 as well where no direction lies above the plane (in
    /// sets of a few directions).
    std::array<float, 2> means() const {
        return {weight > 0 ? static_cast<float>(t / weight) : 1.0f,
                cosine > 0 ? static_cast<float>(t_cosine / cosine) : 1.0f};
    }
};

}  // namespace hairbake
