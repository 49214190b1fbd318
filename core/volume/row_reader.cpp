#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/volume/row_reader.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>
//
#include <algorithm>
#include <cmath>

#include "core/base/assert.h"
#include "core/volume/row_reader.h"

#ifndef HAIRBAKE_ROW_READER_INPUT
#define HAIRBAKE_ROW_READER_INPUT
namespace hairbake {

/// What the loop over the slots reads, the same for every block.
struct RowReaderInput {
    std::span<const std::uint32_t> rows;
    std::span<const float> values;
    std::span<const float> scales;  ///< [8]
    std::size_t directions, components;
};

}  // namespace hairbake
#endif

HWY_BEFORE_NAMESPACE();
namespace hairbake::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// One slot at a time: the weights of a direction are one load, and its components one vector.
void add_rows(const RowReaderInput& input, const SweepBlock& block, const PointSlots& slots, SweepSums& sums) {
    constexpr std::size_t width = DirectionWeights::most_components;
    const hn::CappedTag<float, width> d;
    const hn::RebindToSigned<decltype(d)> di;
    alignas(64) std::int32_t terms[width];
    for (std::size_t i = 0; i < block.count; ++i) {
        const std::uint32_t point = slots.point[block.first + i];
        if (point == PointSlots::no_point) continue;
        const float* row = input.values.data() + std::size_t{input.rows[point]} * input.directions * width;
        for (std::size_t part = 0; part < width; part += hn::Lanes(d)) {
            auto sum = hn::Zero(d);
            for (std::size_t k = 0; k < block.directions.size(); ++k)
                sum =
                    hn::MulAdd(hn::Set(d, block.t[k][i]), hn::LoadU(d, row + block.directions[k] * width + part), sum);
            hn::Store(hn::NearestInt(hn::Mul(sum, hn::LoadU(d, input.scales.data() + part))), di, terms + part);
        }
        for (std::size_t c = 0; c < input.components; ++c) sums.values[c * sums.slots + block.first + i] += terms[c];
    }
}

}  // namespace hairbake::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hairbake {
namespace {
HWY_EXPORT(add_rows);

/// The largest power of two that keeps every row's sum of a component within 30 bits.
float scale_of(const DirectionWeights& weights, std::size_t component) {
    double largest = 1;
    const std::size_t rows = weights.values.size() / (weights.directions * weights.components);
    for (std::size_t row = 0; row < rows; ++row) {
        double sum = 0;
        for (std::size_t k = 0; k < weights.directions; ++k)
            sum += std::abs(double(weights.of(static_cast<std::uint32_t>(row), k)[component]));
        largest = std::max(largest, sum);
    }
    return static_cast<float>(std::exp2(30 - std::ceil(std::log2(largest))));
}

}  // namespace

RowReader::RowReader(const PointSet& points, const DirectionWeights& weights)
    : SweepReader(points), directions_(weights.directions), components_(weights.components), rows_(points.size()) {
    constexpr std::size_t width = DirectionWeights::most_components;
    HAIRBAKE_ASSERT(components_ >= 1 && components_ <= width && weights.rows.size() == points.size());
    for (std::size_t i = 0; i < rows_.size(); ++i)
        rows_[i] = weights.rows[points.model_index.empty() ? i : points.model_index[i]];
    values_.resize(weights.values.size() / components_ * width);
    for (std::size_t i = 0; i < weights.values.size(); ++i)
        values_[i / components_ * width + i % components_] = weights.values[i];
    for (std::size_t c = 0; c < components_; ++c) scales_.push_back(scale_of(weights, c));
}

void RowReader::add(const SweepBlock& block, const PointSlots& slots, SweepSums& sums) const {
    HAIRBAKE_ASSERT(sums.components == components_);
    alignas(64) float scales[DirectionWeights::most_components] = {};
    std::copy(scales_.begin(), scales_.end(), scales);
    HWY_DYNAMIC_DISPATCH(add_rows)({rows_, values_, scales, directions_, components_}, block, slots, sums);
}

}  // namespace hairbake
#endif
