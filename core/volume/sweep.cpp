#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/volume/sweep.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>
//
#include <hwy/contrib/math/math-inl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/volume/sweep.h"

#ifndef HAIRBAKE_SWEEP_PATH
#define HAIRBAKE_SWEEP_PATH
namespace hairbake {

/// One direction's rays. Ray (U, V) lies in voxel column (U + shift_u(s), V + shift_v(s)) at the middle of slice s.
struct RayPath {
    float slope_u, slope_v;       ///< d u / d s, d v / d s
    float per_slice;              ///< length of the way through one slice, in voxels
    std::array<float, 6> square;  ///< l l^T, off-diagonal entries doubled: l.T.l = square . T
    Vec3f direction;
    std::array<float, SweepDirection::most_weights> weights;
    int base_u, base_v;  ///< ray stored first is (base_u, base_v)
    int stride, rows;

    static int shift(float slope, int s) {
        return static_cast<int>(std::floor((static_cast<float>(s) + 0.5f) * slope + 0.5f));
    }
};

/// What one walk through the slices reads.
struct Walk {
    const SliceLayout& layout;
    const ReceiverSlots* receivers;
    std::span<const RayPath> paths;
    bool ascending;
    float scale;
    SweepMask mask;
};

}  // namespace hairbake
#endif

HWY_BEFORE_NAMESPACE();
namespace hairbake::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using F = hn::CappedTag<float, 16>;
using I = hn::RebindToSigned<F>;

/// slab[lane] = optical depth of one slice for every texel of `tile`.
void fill_slab(const SliceLayout& layout, std::uint32_t tile, std::size_t at, std::span<const RayPath> paths,
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
        for (std::size_t k = 0; k < paths.size(); ++k) {
            const auto& q = paths[k].square;
            auto along = hn::Mul(xx, hn::Set(d, q[0]));
            along = hn::MulAdd(yy, hn::Set(d, q[1]), along);
            along = hn::MulAdd(zz, hn::Set(d, q[2]), along);
            along = hn::MulAdd(xy, hn::Set(d, q[3]), along);
            along = hn::MulAdd(xz, hn::Set(d, q[4]), along);
            along = hn::MulAdd(yz, hn::Set(d, q[5]), along);
            const auto squared = hn::Mul(trace, hn::Max(zero, hn::Sub(trace, along)));
            hn::StoreU(hn::Mul(hn::Sqrt(squared), hn::Set(d, paths[k].per_slice)), d, &scratch.slab[k][at + t]);
        }
    }
}

/// Adds the slab of `tile` to the rays that pass it in slice s.
void add_slab(const SliceLayout& layout, std::uint32_t tile, std::size_t at, int s, std::span<const RayPath> paths,
              SweepScratch& scratch) {
    constexpr hn::CappedTag<float, 8> d;
    for (std::size_t k = 0; k < paths.size(); ++k) {
        const RayPath& path = paths[k];
        const int u = layout.tiles[tile].u - RayPath::shift(path.slope_u, s) - path.base_u;
        const int v = layout.tiles[tile].v - RayPath::shift(path.slope_v, s) - path.base_v;
        for (int row = 0; row < 8; ++row) {
            float* depth = &scratch.depth[k][static_cast<std::size_t>((v + row) * path.stride + u)];
            const float* slab = &scratch.slab[k][at + 8 * static_cast<std::size_t>(row)];
            for (std::size_t i = 0; i < 8; i += hn::Lanes(d))
                hn::StoreU(hn::Add(hn::LoadU(d, depth + i), hn::LoadU(d, slab + i)), d, depth + i);
        }
    }
}

/// Where the rays stored from `base` on pass position u of slice position s: ray i takes [i, i + 1).
template <class V>
HWY_INLINE V ray_at(V u, V s, float slope, int base) {
    const F d;
    return hn::Sub(hn::NegMulAdd(s, hn::Set(d, slope), u), hn::Set(d, static_cast<float>(base)));
}

/// Optical depth of a group of slots along one path: the nearest ray before the slice, then the own voxel.
template <class V>
HWY_INLINE V depth_at(const RayPath& path, const float* depth, const float* slab, V u, V v, V s, V inside,
                      hn::Vec<I> texel) {
    const F d;
    const I di;
    const auto ray_u = ray_at(u, s, path.slope_u, path.base_u), ray_v = ray_at(v, s, path.slope_v, path.base_v);
    const auto column = hn::ConvertTo(di, ray_u), row = hn::ConvertTo(di, ray_v);  // both are positive
    const auto at = hn::Add(hn::Mul(row, hn::Set(di, path.stride)), column);
    const auto before = hn::GatherIndex(d, depth, at);
    return hn::MulAdd(inside, hn::GatherIndex(d, slab, texel), before);
}

/// Adds value * scale to the integers at `sum`.
template <class V>
HWY_INLINE void add_fixed(V value, V scale, std::int32_t* sum) {
    const I di;
    hn::StoreU(hn::Add(hn::LoadU(di, sum), hn::NearestInt(hn::Mul(value, scale))), di, sum);
}

/// t where the slots from i on see the light of direction k, else 0.
template <class V>
HWY_INLINE V mask_blocked(V t, std::span<const std::uint8_t> mask, std::size_t i, std::size_t k) {
    if (mask.empty()) return t;
    const F d;
    const I di;
    const auto bits = hn::PromoteTo(di, hn::LoadU(hn::Rebind<std::uint8_t, I>(), &mask[i]));
    return hn::IfThenElseZero(hn::RebindMask(d, hn::TestBit(bits, hn::Set(di, 1 << k))), t);
}

/// Reads every slot of slice s before the slice is added to the rays.
void read_slots(const Walk& walk, int s, const SweepScratch& scratch, SweepSums& sums) {
    const SliceLayout& layout = walk.layout;
    const std::span<const RayPath> paths = walk.paths;
    const F d;
    const I di;
    const auto scale_v = hn::Set(d, walk.scale);
    const std::size_t end = layout.slot_begin[static_cast<std::size_t>(s) + 1];
    for (std::size_t i = layout.slot_begin[static_cast<std::size_t>(s)]; i < end; i += hn::Lanes(d)) {
        const auto u = hn::LoadU(d, &layout.slot_u[i]), v = hn::LoadU(d, &layout.slot_v[i]);
        const auto along = hn::LoadU(d, &layout.slot_s[i]);
        const auto texel = hn::BitCast(di, hn::LoadU(hn::RebindToUnsigned<F>(), &layout.slot_texel[i]));
        // Share of the slice between the vertex and the light's side of it.
        const auto inside = walk.ascending ? hn::Sub(hn::Set(d, static_cast<float>(s + 1)), along)
                                           : hn::Sub(along, hn::Set(d, static_cast<float>(s)));
        alignas(64) float t[kSweepLanes][16];
        for (std::size_t k = 0; k < paths.size(); ++k) {
            const auto depth =
                depth_at(paths[k], scratch.depth[k].data(), scratch.slab[k].data(), u, v, along, inside, texel);
            hn::Store(mask_blocked(hn::Exp(d, hn::Neg(depth)), walk.mask.vertices, i, k), d, t[k]);
        }
        for (std::size_t c = 0; c < sums.components; ++c) {
            auto value = hn::Zero(d);
            for (std::size_t k = 0; k < paths.size(); ++k)
                value = hn::MulAdd(hn::Load(d, t[k]), hn::Set(d, paths[k].weights[c]), value);
            add_fixed(value, scale_v, &sums.values[c * sums.slots + i]);
        }
    }
}

/// Optical depth of a group of receiver slots along one path: no ray passes a point outside the lattice, and a point
/// without a texel has nothing in its own voxel.
template <class V>
HWY_INLINE V receiver_depth(const RayPath& path, const float* depth, const float* slab, V u, V v, V s, V inside,
                            hn::Vec<I> texel) {
    const F d;
    const I di;
    const auto ray_u = ray_at(u, s, path.slope_u, path.base_u), ray_v = ray_at(v, s, path.slope_v, path.base_v);
    const auto zero = hn::Zero(d);
    const auto met = hn::And(hn::And(hn::Ge(ray_u, zero), hn::Lt(ray_u, hn::Set(d, static_cast<float>(path.stride)))),
                             hn::And(hn::Ge(ray_v, zero), hn::Lt(ray_v, hn::Set(d, static_cast<float>(path.rows)))));
    const auto column = hn::ConvertTo(di, hn::IfThenElseZero(met, ray_u));
    const auto row = hn::ConvertTo(di, hn::IfThenElseZero(met, ray_v));
    const auto at = hn::Add(hn::Mul(row, hn::Set(di, path.stride)), column);
    const auto before = hn::IfThenElseZero(met, hn::GatherIndex(d, depth, at));
    const auto has_texel = hn::RebindMask(d, hn::Gt(texel, hn::Set(di, ReceiverSlots::no_texel)));
    const auto own = hn::IfThenElseZero(has_texel, hn::GatherIndex(d, slab, hn::Max(texel, hn::Zero(di))));
    return hn::MulAdd(hn::IfThenElseZero(has_texel, inside), own, before);
}

/// Reads the receiver's slots of slice s, -1 to layout.slices, before the slice is added to the rays.
void read_receivers(const Walk& walk, int s, const SweepScratch& scratch, SweepSums& sums) {
    const ReceiverSlots& slots = *walk.receivers;
    const std::span<const RayPath> paths = walk.paths;
    const F d;
    const I di;
    const auto scale_v = hn::Set(d, walk.scale), zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    const std::size_t end = slots.begin[static_cast<std::size_t>(s + 2)];
    for (std::size_t i = slots.begin[static_cast<std::size_t>(s + 1)]; i < end; i += hn::Lanes(d)) {
        const auto u = hn::LoadU(d, &slots.u[i]), v = hn::LoadU(d, &slots.v[i]), along = hn::LoadU(d, &slots.s[i]);
        const auto nx = hn::LoadU(d, &slots.normal_x[i]), ny = hn::LoadU(d, &slots.normal_y[i]),
                   nz = hn::LoadU(d, &slots.normal_z[i]);
        const auto texel = hn::LoadU(di, &slots.texel[i]);
        const auto inside = walk.ascending ? hn::Sub(hn::Set(d, static_cast<float>(s + 1)), along)
                                           : hn::Sub(along, hn::Set(d, static_cast<float>(s)));
        auto plain = zero, weighted = zero, weight = zero, cosine = zero;
        for (std::size_t k = 0; k < paths.size(); ++k) {
            const Vec3f& l = paths[k].direction;
            const auto n_dot_l = hn::Max(
                zero, hn::MulAdd(nx, hn::Set(d, l.x), hn::MulAdd(ny, hn::Set(d, l.y), hn::Mul(nz, hn::Set(d, l.z)))));
            const auto above = hn::IfThenElseZero(hn::Gt(n_dot_l, zero), one);
            const auto depth =
                receiver_depth(paths[k], scratch.depth[k].data(), scratch.slab[k].data(), u, v, along, inside, texel);
            const auto t = mask_blocked(hn::Exp(d, hn::Neg(depth)), walk.mask.receivers, i, k);
            plain = hn::MulAdd(above, t, plain);
            weighted = hn::MulAdd(n_dot_l, t, weighted);
            weight = hn::Add(weight, above);
            cosine = hn::Add(cosine, n_dot_l);
        }
        std::int32_t* sum = &sums.values[i];
        add_fixed(plain, scale_v, sum);
        add_fixed(weighted, scale_v, sum + sums.slots);
        add_fixed(weight, scale_v, sum + 2 * sums.slots);
        add_fixed(cosine, scale_v, sum + 3 * sums.slots);
    }
}

void walk_slice(const Walk& walk, int s, SweepScratch& scratch, SweepTotals& totals) {
    const SliceLayout& layout = walk.layout;
    const bool in_grid = s >= 0 && s < layout.slices;
    const std::uint32_t begin = in_grid ? layout.tile_begin[static_cast<std::size_t>(s)] : 0;
    const std::uint32_t end = in_grid ? layout.tile_begin[static_cast<std::size_t>(s) + 1] : 0;
    const auto at = [&](std::uint32_t tile) { return std::size_t{SliceLayout::tile_texels} * (tile - begin); };
    for (std::size_t k = 0; k < walk.paths.size(); ++k)
        if (scratch.slab[k].size() < at(end)) scratch.slab[k].resize(at(end));
    for (std::uint32_t tile = begin; tile < end; ++tile) fill_slab(layout, tile, at(tile), walk.paths, scratch);
    if (begin < end && totals.vertices.slots > 0) read_slots(walk, s, scratch, totals.vertices);
    if (totals.receivers.slots > 0) read_receivers(walk, s, scratch, totals.receivers);
    for (std::uint32_t tile = begin; tile < end; ++tile) add_slab(layout, tile, at(tile), s, walk.paths, scratch);
}

/// Light comes from the upper end when the direction ascends along the axis.
void walk_slices(const Walk& walk, SweepScratch& scratch, SweepTotals& totals) {
    for (int step = -1; step <= walk.layout.slices; ++step)
        walk_slice(walk, walk.ascending ? walk.layout.slices - 1 - step : step, scratch, totals);
}

}  // namespace hairbake::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hairbake {
namespace {

HWY_EXPORT(walk_slices);

/// The rays of a lattice line that meet any of `size` columns in any slice, with a margin of two rays.
void cover(float slope, int slices, int size, int& base, int& count) {
    const int first = RayPath::shift(slope, 0), last = RayPath::shift(slope, slices - 1);
    base = -std::max(first, last) - 2;
    count = size - std::min(first, last) + 2 - base;
}

RayPath make_path(const SliceLayout& layout, const SweepDirection& direction) {
    RayPath path;
    const Vec3d& l = direction.l;
    const double major = l[layout.axis];
    path.slope_u = static_cast<float>(l[layout.axis_u] / major);
    path.slope_v = static_cast<float>(l[layout.axis_v] / major);
    path.per_slice = static_cast<float>(1 / std::abs(major));
    const Vec3f f(l);
    path.square = {f.x * f.x, f.y * f.y, f.z * f.z, 2 * f.x * f.y, 2 * f.x * f.z, 2 * f.y * f.z};
    path.direction = f;
    path.weights.fill(0);
    std::copy(direction.weights.begin(), direction.weights.end(), path.weights.begin());
    cover(path.slope_u, layout.slices, layout.size_u, path.base_u, path.stride);
    cover(path.slope_v, layout.slices, layout.size_v, path.base_v, path.rows);
    return path;
}

}  // namespace

float sweep_scale(int directions) {
    int bits = 30;
    for (int count = 1; count < directions; count *= 2) --bits;
    return static_cast<float>(1 << bits);
}

void sweep(const SliceLayout& layout, const ReceiverSlots* receivers, std::span<const SweepDirection> directions,
           float scale, const SweepMask& mask, SweepScratch& scratch, SweepTotals& totals) {
    std::array<RayPath, kSweepLanes> paths;
    for (std::size_t k = 0; k < directions.size(); ++k) {
        paths[k] = make_path(layout, directions[k]);
        scratch.depth[k].assign(static_cast<std::size_t>(paths[k].stride) * static_cast<std::size_t>(paths[k].rows), 0);
        if (scratch.slab[k].empty()) scratch.slab[k].resize(SliceLayout::tile_texels);  // receivers read one always
    }
    const Walk walk{
        layout, receivers, std::span<const RayPath>(paths.data(), directions.size()), directions[0].l[layout.axis] > 0,
        scale,  mask};
    HWY_DYNAMIC_DISPATCH(walk_slices)(walk, scratch, totals);
}

}  // namespace hairbake
#endif
