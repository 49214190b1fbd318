// Real orthonormal spherical harmonics.
//
// Order l * l + l + m, z is the polar axis, no Condon-Shortley phase: Y_0 = 1/sqrt(4 pi), Y_1 = sqrt(3/(4 pi)) (y, z,
// x), as three.js and Filament order them (docs/math.md, "Spherical harmonics"). "Bands" counts l = 0 .. bands - 1:
// bands * bands coefficients.
#pragma once

#include <span>
#include <vector>

#include "core/base/vec.h"

namespace hairbake {

/// Evaluates all harmonics of a number of bands. Immutable after construction, so thread-safe.
/// The recurrence runs over fully normalised associated Legendre functions, which stays accurate for hundreds of bands
/// (Holmes and Featherstone 2002, section 2.1: forward column method; underflow near the poles is harmless below 1000).
class ShBasis {
public:
    /// `bands` in [1, 256].
    explicit ShBasis(int bands);

    int bands() const { return bands_; }
    int count() const { return bands_ * bands_; }

    /// Y_lm of a unit direction into `values`, [count()].
    void evaluate(const Vec3d& direction, std::span<double> values) const;

    /// The normalised Legendre functions of one order m: out[l - m] = P_lm(z) for l = m .. bands - 1, such that
    /// P_lm exp(i m phi) is orthonormal. `sine` is sqrt(1 - z^2).
    void legendre_column(int m, double z, double sine, std::span<double> out) const;

private:
    std::size_t column_begin(int m) const { return column_begin_[m]; }
    void run_column(int m, double z, double first, std::span<double> out) const;

    int bands_;
    std::vector<std::size_t> column_begin_;  // first coefficient of order m
    std::vector<double> a_, b_;              // P_l = a (z P_l-1 - b P_l-2)
    std::vector<double> first_;              // P_mm / sin^m
};

}  // namespace hairbake
