#include "core/volume/fixed_point_sums.h"

#include "core/base/assert.h"
#include "core/base/parallel.h"

namespace hairbake {

void FixedPointSums::add(std::span<const std::uint32_t> point_of_slot, std::span<const SweepSums> parts) {
    for ([[maybe_unused]] const SweepSums& part : parts)
        HAIRBAKE_ASSERT(part.slots == 0 || (part.slots == point_of_slot.size() && part.components == components()));
    const std::size_t count = components();
    parallel_for(point_of_slot.size(), 1 << 15, [&](std::size_t begin, std::size_t end) {
        for (const SweepSums& part : parts)
            for (std::size_t i = begin; i < end && part.slots > 0; ++i) {
                if (point_of_slot[i] == PointSlots::no_point) continue;
                std::int32_t* sum = &values_[std::size_t{point_of_slot[i]} * count];
                for (std::size_t c = 0; c < count; ++c) sum[c] += part.values[c * part.slots + i];
            }
    });
}

}  // namespace hairbake
