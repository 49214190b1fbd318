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
    int base_u, base_v;  ///< ray stored first is (base_u, base_v)
    int stride, rows;

    static int shift(float slope, int s) {
        return static_cast<int>(std::floor((static_cast<float>(s) + 0.5f) * slope + 0.5f));
    }
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

/// Optical depth of a group of slots along one path: the nearest ray before the slice, then the own voxel.
template <class V>
HWY_INLINE V depth_at(const RayPath& path, const float* depth, const float* slab, V u, V v, V s, V inside,
                      hn::Vec<I> texel) {
    const F d;
    const I di;
    const auto ray_u =
        hn::Sub(hn::NegMulAdd(s, hn::Set(d, path.slope_u), u), hn::Set(d, static_cast<float>(path.base_u)));
    const auto ray_v =
        hn::Sub(hn::NegMulAdd(s, hn::Set(d, path.slope_v), v), hn::Set(d, static_cast<float>(path.base_v)));
    const auto column = hn::ConvertTo(di, ray_u), row = hn::ConvertTo(di, ray_v);  // both are positive
    const auto at = hn::Add(hn::Mul(row, hn::Set(di, path.stride)), column);
    const auto before = hn::GatherIndex(d, depth, at);
    return hn::MulAdd(inside, hn::GatherIndex(d, slab, texel), before);
}

/// Reads every slot of slice s before the slice is added to the rays.
void read_slots(const SliceLayout& layout, int s, bool ascending, std::span<const RayPath> paths, float scale,
                std::span<const std::uint8_t> seen, const SweepScratch& scratch, SweepSums& sums) {
    const F d;
    const I di;
    const hn::Rebind<std::uint8_t, I> d8;
    const auto scale_v = hn::Set(d, scale);
    const std::size_t end = layout.slot_begin[static_cast<std::size_t>(s) + 1];
    for (std::size_t i = layout.slot_begin[static_cast<std::size_t>(s)]; i < end; i += hn::Lanes(d)) {
        const auto u = hn::LoadU(d, &layout.slot_u[i]), v = hn::LoadU(d, &layout.slot_v[i]);
        const auto along = hn::LoadU(d, &layout.slot_s[i]);
        const auto texel = hn::BitCast(di, hn::LoadU(hn::RebindToUnsigned<F>(), &layout.slot_texel[i]));
        // Share of the slice between the vertex and the light's side of it.
        const auto inside = ascending ? hn::Sub(hn::Set(d, static_cast<float>(s + 1)), along)
                                      : hn::Sub(along, hn::Set(d, static_cast<float>(s)));
        auto t0 = hn::Zero(d), tx = t0, ty = t0, tz = t0;
        for (std::size_t k = 0; k < paths.size(); ++k) {
            const auto depth =
                depth_at(paths[k], scratch.depth[k].data(), scratch.slab[k].data(), u, v, along, inside, texel);
            auto t = hn::Exp(d, hn::Neg(depth));
            if (!seen.empty()) {
                const auto bits = hn::PromoteTo(di, hn::LoadU(d8, &seen[i]));
                t = hn::IfThenElseZero(hn::RebindMask(d, hn::TestBit(bits, hn::Set(di, 1 << k))), t);
            }
            t0 = hn::Add(t0, t);
            tx = hn::MulAdd(t, hn::Set(d, paths[k].direction.x), tx);
            ty = hn::MulAdd(t, hn::Set(d, paths[k].direction.y), ty);
            tz = hn::MulAdd(t, hn::Set(d, paths[k].direction.z), tz);
        }
        const auto add = [&](std::size_t component, auto value) {
            std::int32_t* sum = &sums.values[component * sums.slots + i];
            hn::StoreU(hn::Add(hn::LoadU(di, sum), hn::NearestInt(hn::Mul(value, scale_v))), di, sum);
        };
        add(0, t0);
        add(1, tx);
        add(2, ty);
        add(3, tz);
    }
}

void walk(const SliceLayout& layout, std::span<const RayPath> paths, bool ascending, float scale,
          std::span<const std::uint8_t> seen, SweepScratch& scratch, SweepSums& sums) {
    for (int step = 0; step < layout.slices; ++step) {
        // Light comes from the upper end when the direction ascends along the axis.
        const int s = ascending ? layout.slices - 1 - step : step;
        const std::uint32_t begin = layout.tile_begin[static_cast<std::size_t>(s)];
        const std::uint32_t end = layout.tile_begin[static_cast<std::size_t>(s) + 1];
        if (begin == end) continue;
        const auto at = [&](std::uint32_t tile) { return std::size_t{SliceLayout::tile_texels} * (tile - begin); };
        for (std::size_t k = 0; k < paths.size(); ++k)
            if (scratch.slab[k].size() < at(end)) scratch.slab[k].resize(at(end));
        for (std::uint32_t tile = begin; tile < end; ++tile) fill_slab(layout, tile, at(tile), paths, scratch);
        read_slots(layout, s, ascending, paths, scale, seen, scratch, sums);
        for (std::uint32_t tile = begin; tile < end; ++tile) add_slab(layout, tile, at(tile), s, paths, scratch);
    }
}

}  // namespace hairbake::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hairbake {
namespace {

HWY_EXPORT(walk);

/// The rays of a lattice line that meet any of `size` columns in any slice, with a margin of two rays.
void cover(float slope, int slices, int size, int& base, int& count) {
    const int first = RayPath::shift(slope, 0), last = RayPath::shift(slope, slices - 1);
    base = -std::max(first, last) - 2;
    count = size - std::min(first, last) + 2 - base;
}

RayPath make_path(const SliceLayout& layout, const Vec3d& l) {
    RayPath path;
    const double major = l[layout.axis];
    path.slope_u = static_cast<float>(l[layout.axis_u] / major);
    path.slope_v = static_cast<float>(l[layout.axis_v] / major);
    path.per_slice = static_cast<float>(1 / std::abs(major));
    const Vec3f f(l);
    path.square = {f.x * f.x, f.y * f.y, f.z * f.z, 2 * f.x * f.y, 2 * f.x * f.z, 2 * f.y * f.z};
    path.direction = f;
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

void sweep(const SliceLayout& layout, std::span<const Vec3d> directions, float scale,
           std::span<const std::uint8_t> seen, SweepScratch& scratch, SweepSums& sums) {
    std::array<RayPath, kSweepLanes> paths;
    for (std::size_t k = 0; k < directions.size(); ++k) {
        paths[k] = make_path(layout, directions[k]);
        scratch.depth[k].assign(static_cast<std::size_t>(paths[k].stride) * static_cast<std::size_t>(paths[k].rows), 0);
    }
    HWY_DYNAMIC_DISPATCH(walk)
    (layout, std::span<const RayPath>(paths.data(), directions.size()), directions[0][layout.axis] > 0, scale, seen,
     scratch, sums);
}

}  // namespace hairbake
#endif
