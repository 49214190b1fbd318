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

#include "core/base/assert.h"
#include "core/base/parallel.h"
#include "core/volume/near_field.h"
#include "core/volume/near_field_pieces-inl.h"
#include "core/volume/own_shadow.h"

#ifndef HAIRBAKE_NEAR_FIELD_INPUT
#define HAIRBAKE_NEAR_FIELD_INPUT
namespace hairbake {

/// The input of the correction, the same for every brick.
struct NearFieldInput {
    const StrandGeometry& strands;
    const HairVolume& volume;
    const NearFieldWindow& window;
    std::span<const std::vector<AngularMean>> means;
    const OwnShadow& own;
};

}  // namespace hairbake
#endif

HWY_BEFORE_NAMESPACE();
namespace hairbake::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// F_grid of a vertex in local voxel `voxel`, without the factor 1 / 4 pi: the voxels around it, each seen in the
/// direction of its centre.
template <std::size_t M>
MeanValues<M> grid_depth(const Neighborhood& near, int voxel, const NearFieldWindow& window,
                         const VertexMeans<M>& means) {
    const F d;
    const I di;
    std::array<Vec3f, M> slopes;
    for (std::size_t m = 0; m < M; ++m) slopes[m] = means[m].slope / means[m].average;
    alignas(64) float sums[M][16] = {};
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
        const auto weighted = hn::Mul(hn::Load(d, window.weight.data() + o), depth);
        for (std::size_t m = 0; m < M; ++m) {
            const Vec3f& slope = slopes[m];
            const auto toward =
                hn::MulAdd(x, hn::Set(d, slope.x), hn::MulAdd(y, hn::Set(d, slope.y), hn::Mul(z, hn::Set(d, slope.z))));
            const auto visible = hn::Max(hn::Zero(d), hn::Add(hn::Set(d, 1.0f), toward));
            hn::Store(hn::MulAdd(weighted, visible, hn::Load(d, sums[m])), d, sums[m]);
        }
    }
    MeanValues<M> depths{};
    for (std::size_t m = 0; m < M; ++m) depths[m] = hn::GetLane(hn::SumOfLanes(d, hn::Load(d, sums[m])));
    return depths;
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
template <std::size_t M>
MeanValues<M> exact_depth(const Neighborhood& near, const Vec3f& x, const OwnSegments& own, const VertexMeans<M>& means,
                          Reaching<M>& pieces) {
    MeanValues<M> depths{};
    pieces.count = 0;
    for_each_row(near, x, [&](std::size_t begin, std::size_t end) {
        add_to(depths, select(near, begin, end, x, own, means, pieces));
    });
    add_to(depths, integrate(pieces, means));
    return depths;
}

/// The exponents of the correction's factor for the vertex at `place` of volume.sorted, which lies in the brick of
/// `near`.
template <std::size_t M>
HWY_INLINE MeanValues<M> exponents_of(const NearFieldInput& input, std::size_t place, const Neighborhood& near,
                                      const VertexMeans<M>& means, Reaching<M>& pieces) {
    const StrandGeometry& strands = input.strands;
    const std::uint32_t v = input.volume.sorted.vertices[place];
    MeanValues<M> exponents{}, shares;
    float largest_share = 0;
    for (std::size_t m = 0; m < M; ++m) {
        shares[m] = NearFieldWindow::share(means[m].average);
        largest_share = std::max(largest_share, shares[m]);
    }
    if (!(largest_share > 0)) return exponents;
    const OwnSegments own = own_segments(strands, v);
    std::array<OwnShadow::Depth, M> own_depths;
    std::array<Vec3f, M> slopes;
    for (std::size_t m = 0; m < M; ++m)
        if (means[m].average > 0) slopes[m] = means[m].slope / means[m].average;
    input.own.depths(strands, input.volume.frame, input.window, v, slopes, own_depths);
    for (std::size_t m = 0; m < M; ++m) exponents[m] = shares[m] * own_depths[m].swept;
    const Vec3f x = input.volume.sorted.vertex_positions[place] - near.corner;
    if (pieces_around(near, x) > NearFieldWindow::most_pieces) return exponents;
    const int voxel = Neighborhood::voxel(static_cast<int>(x.x), static_cast<int>(x.y), static_cast<int>(x.z));
    const MeanValues<M> smeared = grid_depth(near, voxel, input.window, means);
    const MeanValues<M> exact = exact_depth(near, x, own, means, pieces);
    for (std::size_t m = 0; m < M; ++m) {
        if (!(shares[m] > 0)) continue;
        const float others = (smeared[m] - exact[m]) / (4 * std::numbers::pi_v<float>);
        const float gain = others - own_depths[m].in_window;
        exponents[m] += shares[m] * std::min(gain, NearFieldWindow::most_gain);
    }
    return exponents;
}

/// Corrects up to M means. Where there are fewer the last ones repeat the first and are dropped.
template <std::size_t M>
void correct_means(const NearFieldInput& input, std::size_t first, std::size_t last, const Neighborhood& near,
                   std::span<std::vector<float>> corrected) {
    const std::size_t count = input.means.size();
    Reaching<M> pieces;
    VertexMeans<M> means;
    for (std::size_t place = first; place < last; ++place) {
        for (std::size_t m = 0; m < M; ++m) means[m] = input.means[m < count ? m : 0][place];
        const MeanValues<M> exponents = exponents_of(input, place, near, means, pieces);
        const std::uint32_t v = input.volume.sorted.vertices[place];
        for (std::size_t m = 0; m < count; ++m)
            corrected[m][v] = std::min(1.0f, means[m].average * std::exp(exponents[m]));
    }
}

/// Corrects the vertices [first, last) of volume.sorted, which lie in the brick of `near`. corrected: [means][V].
void correct_vertices(const NearFieldInput& input, std::size_t first, std::size_t last, const Neighborhood& near,
                      std::span<std::vector<float>> corrected) {
    if (input.means.size() == 1)
        correct_means<1>(input, first, last, near, corrected);
    else
        correct_means<kMostMeans>(input, first, last, near, corrected);
}

}  // namespace hairbake::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hairbake {
namespace {
HWY_EXPORT(correct_vertices);
}  // namespace

std::vector<std::vector<float>> correct_near_field(const StrandGeometry& strands, const HairVolume& volume,
                                                   std::span<const std::vector<AngularMean>> means,
                                                   const Progress& progress) {
    HAIRBAKE_ASSERT(means.size() <= kMostMeans);
    for ([[maybe_unused]] const auto& mean : means) HAIRBAKE_ASSERT(mean.size() == strands.vertex_count());
    std::vector<std::vector<float>> corrected(means.size(), std::vector<float>(strands.vertex_count()));
    if (means.empty()) return corrected;
    const NearFieldWindow window;
    const OwnShadow own;
    const NearFieldInput input{strands, volume, window, means, own};
    const SortedStrands& sorted = volume.sorted;
    parallel_for(sorted.brick_count(), 32, [&](std::size_t begin, std::size_t end) {
        progress.check();
        Neighborhood near;
        for (std::size_t b = begin; b < end; ++b) {
            const std::size_t first = sorted.vertex_begin[b], last = sorted.vertex_begin[b + 1];
            if (first == last) continue;
            near.collect(volume, b, strands.opacities);
            for (std::size_t at = first; at < last; at += 1024) {  // a brick may hold the whole model
                progress.check();
                HWY_DYNAMIC_DISPATCH(correct_vertices)(input, at, std::min(last, at + 1024), near, corrected);
            }
        }
    });
    return corrected;
}

}  // namespace hairbake
#endif
