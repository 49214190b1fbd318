#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/volume/weight_reader.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>
//
#include <utility>

#include "core/base/assert.h"
#include "core/volume/add_fixed-inl.h"
#include "core/volume/weight_reader.h"

HWY_BEFORE_NAMESPACE();
namespace hairbake::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// One component of a block whose walk has `lanes` directions; weights[k] is the weight of the walk's direction k.
template <std::size_t lanes>
void add_component(const SweepBlock& block, const std::array<float, kSweepLanes>& weights, float scale,
                   std::int32_t* sum) {
    const SlotFloats d;
    const auto scale_v = hn::Set(d, scale);
    for (std::size_t i = 0; i < block.count; i += hn::Lanes(d)) {
        auto value = hn::Mul(hn::Load(d, block.t[0] + i), hn::Set(d, weights[0]));
        if constexpr (lanes > 1) value = hn::MulAdd(hn::Load(d, block.t[1] + i), hn::Set(d, weights[1]), value);
        if constexpr (lanes > 2) value = hn::MulAdd(hn::Load(d, block.t[2] + i), hn::Set(d, weights[2]), value);
        if constexpr (lanes > 3) value = hn::MulAdd(hn::Load(d, block.t[3] + i), hn::Set(d, weights[3]), value);
        add_fixed(value, scale_v, sum + i);
    }
}

void add_weighted(const SweepBlock& block, std::span<const float> weights, std::span<const float> scales,
                  SweepSums& sums) {
    const std::size_t lanes = block.directions.size();
    for (std::size_t c = 0; c < scales.size(); ++c) {
        std::array<float, kSweepLanes> of_lane{};
        for (std::size_t k = 0; k < lanes; ++k) of_lane[k] = weights[block.directions[k] * scales.size() + c];
        std::int32_t* sum = &sums.values[c * sums.slots + block.first];
        if (lanes == 4) add_component<4>(block, of_lane, scales[c], sum);
        if (lanes == 3) add_component<3>(block, of_lane, scales[c], sum);
        if (lanes == 2) add_component<2>(block, of_lane, scales[c], sum);
        if (lanes == 1) add_component<1>(block, of_lane, scales[c], sum);
    }
}

}  // namespace hairbake::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hairbake {
namespace {
HWY_EXPORT(add_weighted);
}  // namespace

WeightReader::WeightReader(const PointSet& points, std::vector<float> weights, std::vector<float> scales)
    : SweepReader(points), weights_(std::move(weights)), scales_(std::move(scales)) {
    HAIRBAKE_ASSERT(!scales_.empty() && weights_.size() % scales_.size() == 0);
}

void WeightReader::add(const SweepBlock& block, const PointSlots& /*slots*/, SweepSums& sums) const {
    HAIRBAKE_ASSERT(sums.components == scales_.size());
    HWY_DYNAMIC_DISPATCH(add_weighted)(block, weights_, scales_, sums);
}

}  // namespace hairbake
#endif
