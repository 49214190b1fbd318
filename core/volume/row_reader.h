// Sums of the transmittance times weights that depend on the direction and on the point.
#pragma once

#include <vector>

#include "core/visibility/direction_weights.h"
#include "core/volume/sweep_reader.h"

namespace hairbake {

/// The components of a point are those of DirectionWeights.
class RowReader final : public SweepReader {
public:
    /// points:  their model_index finds the rows
    /// weights: finite; must outlive this object
    RowReader(const PointSet& points, const DirectionWeights& weights);

    std::span<const float> scales() const override { return scales_; }
    void add(const SweepBlock& block, const PointSlots& slots, SweepSums& sums) const override;

private:
    std::size_t directions_, components_;
    std::vector<std::uint32_t> rows_;  ///< [P], in the order of the point set
    std::vector<float> values_;        ///< [rows][directions][8], padded with zeros
    std::vector<float> scales_;
};

}  // namespace hairbake
