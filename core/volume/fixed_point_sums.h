// Sums over all directions by point, as fixed-point integers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/volume/sweep_reader.h"

namespace hairbake {

/// The sums of one reader at each point of its set. Integers add up to the same in any order.
class FixedPointSums {
public:
    FixedPointSums(std::size_t points, std::span<const float> scales)
        : scales_(scales.begin(), scales.end()), values_(points * scales.size()) {}

    /// Adds the sums of several threads; each of `parts` has the slots of point_of_slot, or none. Slot i belongs to
    /// point point_of_slot[i], or to none where that is PointSlots::no_point. No point may occur twice.
    void add(std::span<const std::uint32_t> point_of_slot, std::span<const SweepSums> parts);

    std::size_t points() const { return values_.size() / scales_.size(); }
    std::size_t components() const { return scales_.size(); }
    float scale(std::size_t component) const { return scales_[component]; }
    /// [components] of one point; sum = integer / scale(component).
    std::span<const std::int32_t> of(std::size_t point) const {
        return {values_.data() + point * components(), components()};
    }

private:
    std::vector<float> scales_;
    std::vector<std::int32_t> values_;  ///< [point * components + component]
};

}  // namespace hairbake
