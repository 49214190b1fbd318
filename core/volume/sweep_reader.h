// A functional of the transmittance, for the sweep: how many sums it keeps at a point, and how it adds to them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/volume/point_set.h"
#include "core/volume/point_slots.h"

namespace hairbake {

/// Directions that one walk through the grid handles together.
constexpr std::size_t kSweepLanes = 4;

/// The transmittance of some slots in the directions of one walk.
struct SweepBlock {
    static constexpr std::size_t most_slots = 256;

    std::size_t first = 0;                      ///< slot
    std::size_t count = 0;                      ///< a multiple of PointSlots::group, at most most_slots
    std::span<const std::uint32_t> directions;  ///< indices into the direction set, at most kSweepLanes
    /// [direction of the walk][slot - first]: T in [0, 1], 0 where the point's occluder blocks the direction. Each
    /// begins at a multiple of 64 bytes. Where the walk has fewer directions, the last ones are not set.
    std::array<const float*, kSweepLanes> t{};
};

/// Sums over directions at every slot, of one thread. They are fixed-point integers: the order of additions does not
/// matter, so that any number of threads gives the same bits.
struct SweepSums {
    std::size_t components = 0;
    std::size_t slots = 0;
    std::vector<std::int32_t> values;  ///< [component * slots + slot]; sum = value / SweepReader::scales()[component]

    SweepSums() = default;
    SweepSums(std::size_t slot_count, std::size_t component_count)
        : components(component_count), slots(slot_count), values(component_count * slot_count) {}
};

/// Adds up one functional of T over the directions at the points of a set. A functional may weigh T by direction
/// (WeightReader), by direction and the point's vector (HemisphereReader), or use T in another way. The sweep computes
/// T once for all readers of a point set. A functional of other extinctions, exp(-a Omega), needs Omega in SweepBlock
/// beside T. Immutable after construction: several threads call add() at the same time with sums of their own.
class SweepReader {
public:
    /// `points` must outlive the reader.
    explicit SweepReader(const PointSet& points) : points_(points) {}
    virtual ~SweepReader() = default;
    SweepReader(const SweepReader&) = delete;
    SweepReader& operator=(const SweepReader&) = delete;

    const PointSet& points() const { return points_; }
    /// [components] fixed-point scale of each sum. Over all directions the sum's magnitude must stay below 2^31 / scale
    /// (sweep_scale).
    virtual std::span<const float> scales() const = 0;
    /// Adds the block's directions to `sums`, which has a component for each scale.
    virtual void add(const SweepBlock& block, const PointSlots& slots, SweepSums& sums) const = 0;

private:
    const PointSet& points_;
};

/// The largest power of two s such that the sum of `directions` terms of magnitude at most 1, times s, fits 31 bits.
float sweep_scale(std::size_t directions);

}  // namespace hairbake
