#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/volume/sweep.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>
//
#include <hwy/contrib/math/math-inl.h>

#include <algorithm>
#include <cstddef>

#include "core/base/assert.h"
#include "core/volume/sweep.h"
#include "core/volume/sweep_rays.h"

#ifndef HAIRBAKE_SWEEP_WALK
#define HAIRBAKE_SWEEP_WALK
namespace hairbake {

/// The input of one walk through the slices.
struct Walk {
    const SliceLayout& layout;
    std::span<const std::uint32_t> directions;
    std::span<const SweepRays> rays;  ///< of each direction
    bool ascending;                   ///< the directions go up along the axis
    std::span<const SweepStop> stops;
};

}  // namespace hairbake
#endif

HWY_BEFORE_NAMESPACE();
namespace hairbake::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using F = hn::CappedTag<float, 16>;
using I = hn::RebindToSigned<F>;

/// slab[lane] = optical depth of one slice for every texel of `tile`.
void fill_slab(const SliceLayout& layout, std::uint32_t tile, std::size_t at, std::span<const SweepRays> rays,
               SweepScratch& scratch) {
    constexpr hn::CappedTag<float, 8> d;
    const hn::Rebind<hwy::float16_t, decltype(d)> d16;
    const auto* tensors = reinterpret_cast<const hwy::float16_t*>(
        &layout.tensors[tile * std::size_t{ExtinctionBricks::components} * SliceLayout::tile_texels]);
    const auto zero = hn::Zero(d);
    for (std::size_t t = 0; t < SliceLayout::tile_texels; t += hn::Lanes(d)) {
        const auto load = [&](std::size_t c) {
            return hn::PromoteTo(d, hn::LoadU(d16, tensors + c * SliceLayout::tile_texels + t));
        };
        const auto xx = load(0), yy = load(1), zz = load(2), xy = load(3), xz = load(4), yz = load(5);
        const auto trace = hn::Add(xx, hn::Add(yy, zz));
        for (std::size_t k = 0; k < rays.size(); ++k) {
            const auto& q = rays[k].square;
            auto along = hn::Mul(xx, hn::Set(d, q[0]));
            along = hn::MulAdd(yy, hn::Set(d, q[1]), along);
            along = hn::MulAdd(zz, hn::Set(d, q[2]), along);
            along = hn::MulAdd(xy, hn::Set(d, q[3]), along);
            along = hn::MulAdd(xz, hn::Set(d, q[4]), along);
            along = hn::MulAdd(yz, hn::Set(d, q[5]), along);
            const auto squared = hn::Mul(trace, hn::Max(zero, hn::Sub(trace, along)));
            hn::StoreU(hn::Mul(hn::Sqrt(squared), hn::Set(d, rays[k].per_slice)), d, &scratch.slab[k][at + t]);
        }
    }
}

/// Adds the slab of `tile` to the rays that pass it in slice s.
void add_slab(const SliceLayout& layout, std::uint32_t tile, std::size_t at, int s, std::span<const SweepRays> rays,
              SweepScratch& scratch) {
    constexpr hn::CappedTag<float, 8> d;
    for (std::size_t k = 0; k < rays.size(); ++k) {
        const SweepRays& lattice = rays[k];
        const int u = layout.tiles[tile].u - SweepRays::shift(lattice.slope_u, s) - lattice.base_u;
        const int v = layout.tiles[tile].v - SweepRays::shift(lattice.slope_v, s) - lattice.base_v;
        for (int row = 0; row < 8; ++row) {
            float* depth = &scratch.depth[k][static_cast<std::size_t>((v + row) * lattice.stride + u)];
            const float* slab = &scratch.slab[k][at + 8 * static_cast<std::size_t>(row)];
            for (std::size_t i = 0; i < 8; i += hn::Lanes(d))
                hn::StoreU(hn::Add(hn::LoadU(d, depth + i), hn::LoadU(d, slab + i)), d, depth + i);
        }
    }
}

/// Place of position (u, s) among the rays stored from `base` on: ray i takes [i, i + 1).
template <class V>
HWY_INLINE V ray_at(V u, V s, float slope, int base) {
    const F d;
    return hn::Sub(hn::NegMulAdd(s, hn::Set(d, slope), u), hn::Set(d, static_cast<float>(base)));
}

/// A group of slots as vectors.
struct SlotGroup {
    hn::Vec<F> u, v, s;
    hn::Vec<F> inside;  ///< share of the slice between the point and the light's side of it
    hn::Vec<I> texel;
};

/// Optical depth of a group of points that all have a texel.
HWY_INLINE hn::Vec<F> depth_inside(const SweepRays& rays, const float* depth, const float* slab, const SlotGroup& at) {
    const F d;
    const I di;
    const auto ray_u = ray_at(at.u, at.s, rays.slope_u, rays.base_u),
               ray_v = ray_at(at.v, at.s, rays.slope_v, rays.base_v);
    const auto column = hn::ConvertTo(di, ray_u), row = hn::ConvertTo(di, ray_v);  // both are positive
    const auto ray = hn::Add(hn::Mul(row, hn::Set(di, rays.stride)), column);
    const auto before = hn::GatherIndex(d, depth, ray);
    return hn::MulAdd(at.inside, hn::GatherIndex(d, slab, at.texel), before);
}

/// Optical depth of a group of points anywhere. No ray passes a point beside the lattice, and a point without a texel
/// has no extinction of its own voxel.
HWY_INLINE hn::Vec<F> depth_anywhere(const SweepRays& rays, const float* depth, const float* slab,
                                     const SlotGroup& at) {
    const F d;
    const I di;
    const auto ray_u = ray_at(at.u, at.s, rays.slope_u, rays.base_u),
               ray_v = ray_at(at.v, at.s, rays.slope_v, rays.base_v);
    const auto zero = hn::Zero(d);
    const auto met = hn::And(hn::And(hn::Ge(ray_u, zero), hn::Lt(ray_u, hn::Set(d, static_cast<float>(rays.stride)))),
                             hn::And(hn::Ge(ray_v, zero), hn::Lt(ray_v, hn::Set(d, static_cast<float>(rays.rows)))));
    const auto column = hn::ConvertTo(di, hn::IfThenElseZero(met, ray_u));
    const auto row = hn::ConvertTo(di, hn::IfThenElseZero(met, ray_v));
    const auto ray = hn::Add(hn::Mul(row, hn::Set(di, rays.stride)), column);
    const auto before = hn::IfThenElseZero(met, hn::GatherIndex(d, depth, ray));
    const auto has_texel = hn::RebindMask(d, hn::Gt(at.texel, hn::Set(di, PointSlots::no_texel)));
    const auto own = hn::IfThenElseZero(has_texel, hn::GatherIndex(d, slab, hn::Max(at.texel, hn::Zero(di))));
    return hn::MulAdd(hn::IfThenElseZero(has_texel, at.inside), own, before);
}

/// t where the slots from i on see the light of the walk's direction k, else 0.
template <class V>
HWY_INLINE V mask_blocked(V t, std::span<const std::uint8_t> seen, std::size_t i, std::size_t k) {
    if (seen.empty()) return t;
    const F d;
    const I di;
    const auto bits = hn::PromoteTo(di, hn::LoadU(hn::Rebind<std::uint8_t, I>(), &seen[i]));
    return hn::IfThenElseZero(hn::RebindMask(d, hn::TestBit(bits, hn::Set(di, 1 << k))), t);
}

/// Fills scratch.t with T of the slots [first, first + count), which lie in slice s, and fetches their sums into the
/// cache.
template <bool all_inside>
void fill_block(const Walk& walk, const SweepStop& stop, int s, std::size_t first, std::size_t count,
                SweepScratch& scratch) {
    const PointSlots& slots = stop.slots;
    const F d;
    const I di;
    for (std::size_t i = first; i < first + count; i += hn::Lanes(d)) {
        SlotGroup at{hn::LoadU(d, &slots.u[i]), hn::LoadU(d, &slots.v[i]), hn::LoadU(d, &slots.s[i]), hn::Zero(d),
                     hn::LoadU(di, &slots.texel[i])};
        for (const SweepSums& sums : stop.sums)
            for (std::size_t c = 0; c < sums.components; ++c) hwy::Prefetch(&sums.values[c * sums.slots + i]);
        at.inside = walk.ascending ? hn::Sub(hn::Set(d, static_cast<float>(s + 1)), at.s)
                                   : hn::Sub(at.s, hn::Set(d, static_cast<float>(s)));
        for (std::size_t k = 0; k < walk.rays.size(); ++k) {
            const float *ray_depth = scratch.depth[k].data(), *slab = scratch.slab[k].data();
            const auto depth = all_inside ? depth_inside(walk.rays[k], ray_depth, slab, at)
                                          : depth_anywhere(walk.rays[k], ray_depth, slab, at);
            hn::Store(mask_blocked(hn::Exp(d, hn::Neg(depth)), stop.seen, i, k), d, &scratch.t[k][i - first]);
        }
    }
}

/// Hands the points of slice s, -1 to layout.slices, to their readers. Call it before the slice is added to the rays.
void read_slice(const Walk& walk, const SweepStop& stop, int s, SweepScratch& scratch) {
    const auto row = static_cast<std::size_t>(s + 1);
    SweepBlock block{.directions = walk.directions};
    for (std::size_t k = 0; k < kSweepLanes; ++k) block.t[k] = scratch.t[k].data();
    const std::size_t end = stop.slots.begin[row + 1];
    for (block.first = stop.slots.begin[row]; block.first < end; block.first += block.count) {
        block.count = std::min(SweepBlock::most_slots, end - block.first);
        if (stop.slots.all_inside)
            fill_block<true>(walk, stop, s, block.first, block.count, scratch);
        else
            fill_block<false>(walk, stop, s, block.first, block.count, scratch);
        for (std::size_t r = 0; r < stop.readers.size(); ++r) stop.readers[r]->add(block, stop.slots, stop.sums[r]);
    }
}

void walk_slice(const Walk& walk, int s, SweepScratch& scratch) {
    const SliceLayout& layout = walk.layout;
    const bool in_grid = s >= 0 && s < layout.slices;
    const std::uint32_t begin = in_grid ? layout.tile_begin[static_cast<std::size_t>(s)] : 0;
    const std::uint32_t end = in_grid ? layout.tile_begin[static_cast<std::size_t>(s) + 1] : 0;
    const auto at = [&](std::uint32_t tile) { return std::size_t{SliceLayout::tile_texels} * (tile - begin); };
    for (std::size_t k = 0; k < walk.rays.size(); ++k)
        if (scratch.slab[k].size() < at(end)) scratch.slab[k].resize(at(end));
    for (std::uint32_t tile = begin; tile < end; ++tile) fill_slab(layout, tile, at(tile), walk.rays, scratch);
    for (const SweepStop& stop : walk.stops) read_slice(walk, stop, s, scratch);
    for (std::uint32_t tile = begin; tile < end; ++tile) add_slab(layout, tile, at(tile), s, walk.rays, scratch);
}

/// Light comes from the upper end when the directions ascend along the axis.
void walk_slices(const Walk& walk, SweepScratch& scratch) {
    for (int step = -1; step <= walk.layout.slices; ++step)
        walk_slice(walk, walk.ascending ? walk.layout.slices - 1 - step : step, scratch);
}

}  // namespace hairbake::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hairbake {
namespace {
HWY_EXPORT(walk_slices);
}  // namespace

float sweep_scale(std::size_t directions) {
    int bits = 30;
    for (std::size_t count = 1; count < directions; count *= 2) --bits;
    return static_cast<float>(1 << bits);
}

void sweep(const SliceLayout& layout, std::span<const Vec3d> directions, std::span<const std::uint32_t> walk,
           std::span<const SweepStop> stops, SweepScratch& scratch) {
    HAIRBAKE_ASSERT(!walk.empty() && walk.size() <= kSweepLanes);
    std::array<SweepRays, kSweepLanes> rays;
    for (std::size_t k = 0; k < walk.size(); ++k) {
        rays[k] = make_sweep_rays(layout, directions[walk[k]]);
        scratch.depth[k].assign(rays[k].count(), 0);
        // Padding and points without a texel read the first texel even where the slice has no tile.
        if (scratch.slab[k].empty()) scratch.slab[k].resize(SliceLayout::tile_texels);
    }
    const bool ascending = directions[walk[0]][layout.axis] > 0;
    HWY_DYNAMIC_DISPATCH(walk_slices)
    ({layout, walk, std::span<const SweepRays>(rays.data(), walk.size()), ascending, stops}, scratch);
}

}  // namespace hairbake
#endif
