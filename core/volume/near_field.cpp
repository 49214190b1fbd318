#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/volume/near_field.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>
//
#include <hwy/contrib/math/math-inl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/parallel.h"
#include "core/volume/near_field.h"
#include "core/volume/near_field_window.h"
#include "core/volume/neighborhood.h"

HWY_BEFORE_NAMESPACE();
namespace hairbake::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, 16>;
using I = hn::RebindToSigned<F>;

/// Pieces that reach into a vertex's window, packed for the integral.
struct Reaching {
    static constexpr std::size_t capacity = 1024;  ///< integrated and emptied when full
    alignas(64) float foot[capacity + 16];  ///< s0: piece centre along the piece's axis, from the vertex's foot point
    alignas(64) float distance2[capacity + 16];  ///< D^2: squared distance of the axis from the vertex
    alignas(64) float half_length[capacity + 16];
    alignas(64) float weight[capacity + 16];      ///< opacity * width / h
    alignas(64) float slope_foot[capacity + 16];  ///< slope . (foot point - vertex)
    alignas(64) float slope_axis[capacity + 16];  ///< slope . axis
    std::size_t count = 0;
};

/// Integral of q(d) sin(angle) T(l) / A / d^2 over the packed pieces (without weight of 1 / 4 pi). Along a straight
/// piece at axis distance D with s from the foot point and d^2 = D^2 + s^2, sin(angle) = D / d, so the integrand is
/// D / d^3 - 2 D / (r^2 d) + D d / r^4, with the primitive
/// s / (D d) - (2 / r^2) D asinh(s / D) + (D / 2 r^4)(s d + D^2 asinh(s / D)).
float integrate(const Reaching& pieces, float average) {
    const F d;
    constexpr float r2 = NearFieldWindow::radius * NearFieldWindow::radius;
    const auto zero = hn::Zero(d), half = hn::Set(d, 0.5f), inverse_average = hn::Set(d, 1 / average);
    auto sum = zero;
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
        const auto slope =
            hn::Div(hn::MulAdd(along, hn::Load(d, pieces.slope_axis + i), hn::Load(d, pieces.slope_foot + i)), toward);
        const auto visible = hn::Max(zero, hn::MulAdd(slope, inverse_average, hn::Set(d, 1.0f)));
        const auto term = hn::Mul(hn::Mul(hn::Load(d, pieces.weight + i), integral), visible);
        sum = hn::Add(sum, hn::IfThenElseZero(hn::And(used, hn::Gt(high, low)), term));
    }
    return hn::GetLane(hn::SumOfLanes(d, sum));
}

/// Packs those of the pieces [begin, end) that come within the window of the vertex at x. Returns the integral of what
/// had to make room.
float select(const Neighborhood& near, std::size_t begin, std::size_t end, const Vec3f& x, const AdjacentSegments& own,
             const AngularMean& mean, Reaching& out) {
    const Vec3f& slope = mean.slope;
    float integral = 0;
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
        const auto slope_axis =
            hn::MulAdd(tx, hn::Set(d, slope.x), hn::MulAdd(ty, hn::Set(d, slope.y), hn::Mul(tz, hn::Set(d, slope.z))));
        const auto slope_centre =
            hn::MulAdd(cx, hn::Set(d, slope.x), hn::MulAdd(cy, hn::Set(d, slope.y), hn::Mul(cz, hn::Set(d, slope.z))));
        if (out.count > Reaching::capacity - hn::Lanes(d)) {
            integral += integrate(out, mean.average);
            out.count = 0;
        }
        const std::size_t at = out.count;
        hn::CompressStore(hn::NegMulAdd(foot, slope_axis, slope_centre), keep, d, out.slope_foot + at);
        hn::CompressStore(slope_axis, keep, d, out.slope_axis + at);
        hn::CompressStore(foot, keep, d, out.foot + at);
        hn::CompressStore(distance2, keep, d, out.distance2 + at);
        hn::CompressStore(half_length, keep, d, out.half_length + at);
        out.count += hn::CompressStore(weight, keep, d, out.weight + at);
    }
    return integral;
}

/// F_grid of a vertex in local voxel `voxel`: the voxels around it, each seen in the direction of its centre.
float grid_depth(const Neighborhood& near, int voxel, const NearFieldWindow& window, const AngularMean& mean) {
    const F d;
    const I di;
    const Vec3f slope = mean.slope / mean.average;
    auto sum = hn::Zero(d);
    for (std::size_t o = 0; o < NearFieldWindow::padded; o += hn::Lanes(d)) {
        const auto x = hn::Load(d, window.direction_x.data() + o), y = hn::Load(d, window.direction_y.data() + o);
        const auto z = hn::Load(d, window.direction_z.data() + o);
        const auto at = hn::Add(hn::Load(di, window.step.data() + o), hn::Set(di, voxel));
        const auto component = [&](std::size_t c) { return hn::GatherIndex(d, near.tensor[c].data(), at); };
        const auto trace = component(6);
        auto across = hn::Mul(hn::Mul(x, y), component(3));
        across = hn::MulAdd(hn::Mul(x, z), component(4), across);
        across = hn::MulAdd(hn::Mul(y, z), component(5), across);
        auto along = hn::Add(across, across);
        along = hn::MulAdd(hn::Mul(x, x), component(0), along);
        along = hn::MulAdd(hn::Mul(y, y), component(1), along);
        along = hn::MulAdd(hn::Mul(z, z), component(2), along);
        const auto depth = hn::Sqrt(hn::Mul(trace, hn::Max(hn::Zero(d), hn::Sub(trace, along))));
        const auto toward =
            hn::MulAdd(x, hn::Set(d, slope.x), hn::MulAdd(y, hn::Set(d, slope.y), hn::Mul(z, hn::Set(d, slope.z))));
        const auto visible = hn::Max(hn::Zero(d), hn::Add(hn::Set(d, 1.0f), toward));
        sum = hn::MulAdd(hn::Mul(hn::Load(d, window.weight.data() + o), depth), visible, sum);
    }
    return hn::GetLane(hn::SumOfLanes(d, sum));
}

/// On how many sides of vertex v its strand goes on: 2, at an end 1, at a lone point none.
float own_sides(const StrandGeometry& strands, std::uint32_t v, const AdjacentSegments& own) {
    const bool before = own.first < v && strands.segments[own.first] == Segment::solid;
    const bool after = strands.segments[own.last] == Segment::solid;
    return static_cast<float>(before) + static_cast<float>(after);
}

/// Calls visit(begin, end) for the nine rows of pieces in the cells around local position x.
template <class Visit>
void for_each_row(const Neighborhood& near, const Vec3f& x, const Visit& visit) {
    const int i = Neighborhood::cell_of(x.x), j = Neighborhood::cell_of(x.y), k = Neighborhood::cell_of(x.z);
    for (int row_i = i - 1; row_i <= i + 1; ++row_i)
        for (int row_j = j - 1; row_j <= j + 1; ++row_j) {
            const auto cell = static_cast<std::size_t>(Neighborhood::cell(row_i, row_j, k));
            visit(near.begin[cell - 1], near.begin[cell + 2]);
        }
}

std::size_t pieces_around(const Neighborhood& near, const Vec3f& x) {
    std::size_t count = 0;
    for_each_row(near, x, [&](std::size_t begin, std::size_t end) { count += end - begin; });
    return count;
}

/// F_exact of a vertex at local position x, without the factor 1 / 4 pi.
float exact_depth(const Neighborhood& near, const Vec3f& x, const AdjacentSegments& own, const AngularMean& mean,
                  Reaching& pieces) {
    float depth = 0;
    pieces.count = 0;
    for_each_row(near, x,
                 [&](std::size_t begin, std::size_t end) { depth += select(near, begin, end, x, own, mean, pieces); });
    return depth + integrate(pieces, mean.average);
}

/// Corrects the vertices of one brick, [first, last) of `sorted`.
void correct_vertices(const StrandGeometry& strands, const GridFrame& frame, const SortedStrands& sorted,
                      std::size_t first, std::size_t last, const Neighborhood& near, const NearFieldWindow& window,
                      std::span<const AngularMean> means, std::span<float> corrected) {
    Reaching pieces;
    const auto own_unit = 0.5f * NearFieldWindow::own_strand_beyond / static_cast<float>(frame.voxel_size);
    for (std::size_t place = first; place < last; ++place) {
        const std::uint32_t v = sorted.vertices[place];
        const AngularMean& mean = means[place];
        const AdjacentSegments own = adjacent_segments(strands, v);
        float exponent = own_sides(strands, v, own) * own_unit * strands.opacities[v] * strands.widths[v];
        const float share = NearFieldWindow::share(mean.average);
        const Vec3f x = sorted.vertex_positions[place] - near.corner;
        if (share > 0 && pieces_around(near, x) <= NearFieldWindow::most_pieces) {
            const int voxel = Neighborhood::voxel(static_cast<int>(x.x), static_cast<int>(x.y), static_cast<int>(x.z));
            const float smeared = grid_depth(near, voxel, window, mean);
            const float exact = exact_depth(near, x, own, mean, pieces);
            const float gain = (smeared - exact) / (4 * std::numbers::pi_v<float>);
            exponent += share * std::min(gain, NearFieldWindow::most_gain);
        }
        corrected[v] = std::min(1.0f, mean.average * std::exp(exponent));
    }
}

}  // namespace hairbake::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hairbake {
namespace {
HWY_EXPORT(correct_vertices);
}  // namespace

std::vector<float> correct_near_field(const StrandGeometry& strands, const GridFrame& frame,
                                      const SortedStrands& sorted, const ExtinctionBricks& bricks,
                                      std::span<const AngularMean> means, Progress& progress) {
    const NearFieldWindow window;
    std::vector<float> corrected(means.size());
    parallel_for(sorted.brick_count(), 32, [&](std::size_t begin, std::size_t end) {
        progress.check();
        Neighborhood near;
        for (std::size_t b = begin; b < end; ++b) {
            const std::size_t first = sorted.vertex_begin[b], last = sorted.vertex_begin[b + 1];
            if (first == last) continue;
            near.collect(frame, sorted, bricks, b, strands.opacities);
            for (std::size_t at = first; at < last; at += 1024) {  // a brick may hold the whole model
                progress.check();
                HWY_DYNAMIC_DISPATCH(correct_vertices)
                (strands, frame, sorted, at, std::min(last, at + 1024), near, window, means, corrected);
            }
        }
    });
    return corrected;
}

}  // namespace hairbake
#endif
