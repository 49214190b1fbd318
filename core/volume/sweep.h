// The integrator: walks the extinction grid slice by slice against the light and reads the optical depth at every
// vertex.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/vec.h"
#include "core/volume/receiver_slots.h"
#include "core/volume/slice_layout.h"

namespace hairbake {

/// Directions that one walk handles together: they share the major axis and its sign, so that vertices and tensors are
/// read once.
constexpr int kSweepLanes = 4;

/// A direction away from the hair and the weights of the sums that it adds to (DirectionMoments::weights).
struct SweepDirection {
    static constexpr std::size_t most_weights = 16;
    Vec3d l;                          ///< unit, model axes
    std::span<const double> weights;  ///< at most 16, each of magnitude at most 1
};

/// Sums over directions at every slot, as fixed-point integers: the order of additions does not matter, so any
/// number of threads gives the same bits. value = integer / scale.
struct SweepSums {
    /// Of a vertex: T times each weight. Of a receiver: the four of HemisphereSums, in their order.
    std::size_t components = 0;
    std::size_t slots = 0;
    std::vector<std::int32_t> values;  ///< [component * slots + slot]

    SweepSums() = default;
    SweepSums(std::size_t slot_count, std::size_t component_count)
        : components(component_count), slots(slot_count), values(component_count * slot_count) {}
};

/// The sums that one thread fills. Of no slots: these are not read.
struct SweepTotals {
    static constexpr std::size_t receiver_components = 4;
    SweepSums vertices, receivers;
};

/// Largest power of two s such that sums of `directions` terms of magnitude at most 1 fit 31 bits.
float sweep_scale(int directions);

/// Who sees past the occluder: bit k of a slot tells whether the slot sees the light of the sweep's direction k. Empty:
/// nothing is in the way. [slots]
struct SweepMask {
    std::span<const std::uint8_t> vertices, receivers;
};

/// What one thread needs while it sweeps; reused from walk to walk.
struct SweepScratch {
    std::vector<float> depth[kSweepLanes];  ///< optical depth of every ray so far
    std::vector<float> slab[kSweepLanes];   ///< extinction of the current slice, as tiles
};

/// Adds exp(-Omega) of 1 to kSweepLanes `directions` (major axis layout.axis with one sign, equally many weights) at
/// every slot to `totals`. Rays form a lattice that shifts from slice to slice with the light; a ray
/// takes from each slice the extinction of the voxel it is in at mid-slice; a vertex takes the depth of its nearest
/// ray up to its slice and adds its own voxel's extinction for the way inside the slice. (The design blends four rays
/// before and after the slice; the nearest alone smears less: RMSE 0.0127 against 0.0147 on straight hair, and faster.)
/// A receiver's point outside the grid reads the ray that passes it, before the first slice or after the last; the grid
/// ends where the rays do. `receivers` may be null when totals.receivers is empty.
void sweep(const SliceLayout& layout, const ReceiverSlots* receivers, std::span<const SweepDirection> directions,
           float scale, const SweepMask& mask, SweepScratch& scratch, SweepTotals& totals);

}  // namespace hairbake
