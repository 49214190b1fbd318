// Sums of the transmittance over the hemisphere about each point's normal.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/base/vec.h"
#include "core/volume/sweep_reader.h"

namespace hairbake {

/// The four components of a point are those of HemisphereSums, in their order.
class HemisphereReader final : public SweepReader {
public:
    static constexpr std::size_t components = 4;

    /// points:     their vectors are the normals
    /// directions: unit, as the sweep is given them
    HemisphereReader(const PointSet& points, std::span<const Vec3d> directions);

    std::span<const float> scales() const override { return scales_; }
    void add(const SweepBlock& block, const PointSlots& slots, SweepSums& sums) const override;

private:
    std::vector<Vec3f> directions_;
    std::array<float, components> scales_;
};

}  // namespace hairbake
