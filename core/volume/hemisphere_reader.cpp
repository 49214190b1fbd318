#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/volume/hemisphere_reader.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>
//
#include "core/base/assert.h"
#include "core/volume/add_fixed-inl.h"
#include "core/volume/hemisphere_reader.h"

HWY_BEFORE_NAMESPACE();
namespace hairbake::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void add_hemisphere(const SweepBlock& block, const PointSlots& slots, std::span<const Vec3f> directions, float scale,
                    SweepSums& sums) {
    const SlotFloats d;
    const auto scale_v = hn::Set(d, scale), zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    for (std::size_t i = 0; i < block.count; i += hn::Lanes(d)) {
        const std::size_t slot = block.first + i;
        const auto nx = hn::LoadU(d, &slots.vector_x[slot]), ny = hn::LoadU(d, &slots.vector_y[slot]),
                   nz = hn::LoadU(d, &slots.vector_z[slot]);
        auto plain = zero, weighted = zero, weight = zero, cosine = zero;
        for (std::size_t k = 0; k < block.directions.size(); ++k) {
            const Vec3f& l = directions[block.directions[k]];
            const auto n_dot_l = hn::Max(
                zero, hn::MulAdd(nx, hn::Set(d, l.x), hn::MulAdd(ny, hn::Set(d, l.y), hn::Mul(nz, hn::Set(d, l.z)))));
            const auto above = hn::IfThenElseZero(hn::Gt(n_dot_l, zero), one);
            const auto t = hn::Load(d, block.t[k] + i);
            plain = hn::MulAdd(above, t, plain);
            weighted = hn::MulAdd(n_dot_l, t, weighted);
            weight = hn::Add(weight, above);
            cosine = hn::Add(cosine, n_dot_l);
        }
        std::int32_t* sum = &sums.values[slot];
        add_fixed(plain, scale_v, sum);
        add_fixed(weighted, scale_v, sum + sums.slots);
        add_fixed(weight, scale_v, sum + 2 * sums.slots);
        add_fixed(cosine, scale_v, sum + 3 * sums.slots);
    }
}

}  // namespace hairbake::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hairbake {
namespace {
HWY_EXPORT(add_hemisphere);
}  // namespace

HemisphereReader::HemisphereReader(const PointSet& points, std::span<const Vec3d> directions) : SweepReader(points) {
    HAIRBAKE_ASSERT(points.vectors.size() == points.size());
    directions_.reserve(directions.size());
    for (const Vec3d& l : directions) directions_.emplace_back(l);
    scales_.fill(sweep_scale(directions.size()));
}

void HemisphereReader::add(const SweepBlock& block, const PointSlots& slots, SweepSums& sums) const {
    HAIRBAKE_ASSERT(sums.components == components);
    HWY_DYNAMIC_DISPATCH(add_hemisphere)(block, slots, directions_, scales_[0], sums);
}

}  // namespace hairbake
#endif
