// Sums of the transmittance times weights that depend on the direction alone.
#pragma once

#include <span>
#include <vector>

#include "core/volume/sweep_reader.h"

namespace hairbake {

/// Component c of a point is the sum over the directions k of T_k weights[k * components + c].
class WeightReader final : public SweepReader {
public:
    /// weights: [directions * components]
    /// scales:  [components], see SweepReader::scales
    WeightReader(const PointSet& points, std::vector<float> weights, std::vector<float> scales);

    std::span<const float> scales() const override { return scales_; }
    void add(const SweepBlock& block, const PointSlots& slots, SweepSums& sums) const override;

private:
    std::vector<float> weights_, scales_;
};

}  // namespace hairbake
