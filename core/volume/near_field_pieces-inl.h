// The integral over the strand pieces near a vertex. Include it in a file that Highway compiles once for each SIMD
// target, after <hwy/contrib/math/math-inl.h>.
#ifndef HAIRBAKE_NEAR_FIELD_PIECES
#define HAIRBAKE_NEAR_FIELD_PIECES

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/hair/strand_geometry.h"
#include "core/volume/near_field.h"
#include "core/volume/near_field_window.h"
#include "core/volume/neighborhood.h"

namespace hairbake {

/// A value for each of the M means of a vertex. Code for one mean is compiled apart from that for several.
template <std::size_t M>
using MeanValues = std::array<float, M>;

/// The means of one vertex.
template <std::size_t M>
using VertexMeans = std::array<AngularMean, M>;

/// Pieces that reach into a vertex's window, packed for the integral. Geometry is stored once, and for each mean the
/// part that depends on its slope.
template <std::size_t M>
struct Reaching {
    static constexpr std::size_t capacity = 1024;  ///< integrated and emptied when full
    static constexpr std::size_t size = capacity + 16;

    struct Slopes {
        alignas(64) float foot[size];  ///< slope . (foot point - vertex)
        alignas(64) float axis[size];  ///< slope . axis
    };

    alignas(64) float foot[size];       ///< s0: piece centre along the piece's axis, from the vertex's foot point
    alignas(64) float distance2[size];  ///< D^2: squared distance of the axis from the vertex
    alignas(64) float half_length[size];
    alignas(64) float weight[size];  ///< opacity * width / h
    std::array<Slopes, M> slopes;
    std::size_t count = 0;
};

}  // namespace hairbake
#endif

#if defined(HAIRBAKE_NEAR_FIELD_PIECES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef HAIRBAKE_NEAR_FIELD_PIECES_INL_H
#undef HAIRBAKE_NEAR_FIELD_PIECES_INL_H
#else
#define HAIRBAKE_NEAR_FIELD_PIECES_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace hairbake::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, 16>;
using I = hn::RebindToSigned<F>;

/// For each mean the integral of q(d) sin(angle) T(l) / A / d^2 over the packed pieces, without the factor 1 / 4 pi.
/// A straight piece has the axis distance D; s runs from the foot point, d^2 = D^2 + s^2 and sin(angle) = D / d. So the
/// integrand is D / d^3 - 2 D / (r^2 d) + D d / r^4, with the primitive
/// s / (D d) - (2 / r^2) D asinh(s / D) + (D / 2 r^4)(s d + D^2 asinh(s / D)).
template <std::size_t M>
MeanValues<M> integrate(const Reaching<M>& pieces, const VertexMeans<M>& means) {
    const F d;
    constexpr float r2 = NearFieldWindow::radius * NearFieldWindow::radius;
    const auto zero = hn::Zero(d), half = hn::Set(d, 0.5f);
    MeanValues<M> inverse_averages;
    for (std::size_t m = 0; m < M; ++m) inverse_averages[m] = 1 / means[m].average;
    alignas(64) float sums[M][16] = {};
    for (std::size_t i = 0; i < pieces.count; i += hn::Lanes(d)) {
        const auto used = hn::FirstN(d, pieces.count - i);
        const auto distance2 = hn::Load(d, pieces.distance2 + i), foot = hn::Load(d, pieces.foot + i);
        const auto half_length = hn::Load(d, pieces.half_length + i);
        const auto limit = hn::Sqrt(hn::Max(zero, hn::Sub(hn::Set(d, r2), distance2)));
        const auto low = hn::Max(hn::Sub(foot, half_length), hn::Neg(limit));
        const auto high = hn::Min(hn::Add(foot, half_length), limit);
        const auto distance = hn::Sqrt(distance2);
        const auto d_low = hn::Sqrt(hn::MulAdd(low, low, distance2)),
                   d_high = hn::Sqrt(hn::MulAdd(high, high, distance2));
        const auto log_ratio = hn::Log(d, hn::Div(hn::Max(hn::Add(high, d_high), hn::Set(d, 1e-20f)),
                                                  hn::Max(hn::Add(low, d_low), hn::Set(d, 1e-20f))));
        const auto peak = hn::Div(hn::Sub(hn::Div(high, d_high), hn::Div(low, d_low)), distance);
        const auto taper = hn::Mul(log_ratio, hn::Set(d, -2 / r2));
        const auto rise = hn::Mul(hn::MulAdd(distance2, log_ratio, hn::Sub(hn::Mul(high, d_high), hn::Mul(low, d_low))),
                                  hn::Set(d, 0.5f / (r2 * r2)));
        const auto integral = hn::Max(zero, hn::MulAdd(distance, hn::Add(taper, rise), peak));
        // The integrand peaks at the foot point: the direction is taken half-way from the middle to the nearest point.
        const auto nearest = hn::Min(hn::Max(low, zero), high), middle = hn::Mul(half, hn::Add(low, high));
        const auto along = hn::Mul(half, hn::Add(nearest, middle));
        const auto toward = hn::Sqrt(hn::MulAdd(along, along, distance2));
        const auto reaches = hn::And(used, hn::Gt(high, low));
        const auto weighted = hn::Mul(hn::Load(d, pieces.weight + i), integral);
        for (std::size_t m = 0; m < M; ++m) {
            const auto& slopes = pieces.slopes[m];
            const auto slope =
                hn::Div(hn::MulAdd(along, hn::Load(d, slopes.axis + i), hn::Load(d, slopes.foot + i)), toward);
            const auto inverse_average = hn::Set(d, inverse_averages[m]);
            const auto visible = hn::Max(zero, hn::MulAdd(slope, inverse_average, hn::Set(d, 1.0f)));
            const auto term = hn::IfThenElseZero(reaches, hn::Mul(weighted, visible));
            hn::Store(hn::Add(hn::Load(d, sums[m]), term), d, sums[m]);
        }
    }
    MeanValues<M> integrals{};
    for (std::size_t m = 0; m < M; ++m) integrals[m] = hn::GetLane(hn::SumOfLanes(d, hn::Load(d, sums[m])));
    return integrals;
}

template <std::size_t M>
void add_to(MeanValues<M>& sums, const MeanValues<M>& more) {
    for (std::size_t m = 0; m < M; ++m) sums[m] += more[m];
}

/// Packs those of the pieces [begin, end) that come within the window of the vertex at x. Where `out` is full it is
/// integrated and emptied; returns these integrals.
template <std::size_t M>
HWY_NOINLINE MeanValues<M> select(const Neighborhood& near, std::size_t begin, std::size_t end, const Vec3f& x,
                                  const OwnSegments& own, const VertexMeans<M>& means, Reaching<M>& out) {
    MeanValues<M> integrals{};
    const F d;
    const hn::RebindToSigned<F> di;
    constexpr float r2 = NearFieldWindow::radius * NearFieldWindow::radius;
    for (std::size_t i = begin; i < end; i += hn::Lanes(d)) {
        const auto cx = hn::Sub(hn::LoadU(d, &near.centre_x[i]), hn::Set(d, x.x));
        const auto cy = hn::Sub(hn::LoadU(d, &near.centre_y[i]), hn::Set(d, x.y));
        const auto cz = hn::Sub(hn::LoadU(d, &near.centre_z[i]), hn::Set(d, x.z));
        const auto tx = hn::LoadU(d, &near.axis_x[i]), ty = hn::LoadU(d, &near.axis_y[i]),
                   tz = hn::LoadU(d, &near.axis_z[i]);
        const auto foot = hn::MulAdd(cx, tx, hn::MulAdd(cy, ty, hn::Mul(cz, tz)));
        const auto centre2 = hn::MulAdd(cx, cx, hn::MulAdd(cy, cy, hn::Mul(cz, cz)));
        const auto weight = hn::LoadU(d, &near.weight[i]), least = hn::LoadU(d, &near.least[i]);
        const auto distance2 = hn::Max(hn::NegMulAdd(foot, foot, centre2), hn::Mul(least, least));
        const auto half_length = hn::LoadU(d, &near.half_length[i]);
        const auto beyond = hn::Max(hn::Zero(d), hn::Sub(hn::Abs(foot), half_length));
        const auto segment = hn::LoadU(di, &near.segment[i]);
        const auto is_other = hn::Or(hn::Lt(segment, hn::Set(di, static_cast<std::int32_t>(own.first))),
                                     hn::Gt(segment, hn::Set(di, static_cast<std::int32_t>(own.last))));
        auto keep = hn::And(hn::FirstN(d, end - i), hn::Lt(hn::MulAdd(beyond, beyond, distance2), hn::Set(d, r2)));
        keep = hn::And(hn::RebindMask(d, is_other), keep);
        if (hn::AllFalse(d, keep)) continue;
        if (out.count > Reaching<M>::capacity - hn::Lanes(d)) {
            add_to(integrals, integrate(out, means));
            out.count = 0;
        }
        const std::size_t at = out.count;
        for (std::size_t m = 0; m < M; ++m) {
            const auto slope_x = hn::Set(d, means[m].slope.x), slope_y = hn::Set(d, means[m].slope.y),
                       slope_z = hn::Set(d, means[m].slope.z);
            const auto axis = hn::MulAdd(tx, slope_x, hn::MulAdd(ty, slope_y, hn::Mul(tz, slope_z)));
            const auto centre = hn::MulAdd(cx, slope_x, hn::MulAdd(cy, slope_y, hn::Mul(cz, slope_z)));
            hn::CompressStore(hn::NegMulAdd(foot, axis, centre), keep, d, out.slopes[m].foot + at);
            hn::CompressStore(axis, keep, d, out.slopes[m].axis + at);
        }
        hn::CompressStore(foot, keep, d, out.foot + at);
        hn::CompressStore(distance2, keep, d, out.distance2 + at);
        hn::CompressStore(half_length, keep, d, out.half_length + at);
        out.count += hn::CompressStore(weight, keep, d, out.weight + at);
    }
    return integrals;
}

}  // namespace hairbake::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
