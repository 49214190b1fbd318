// A functional of the transmittance: it turns the sums of T over all directions at each point, which the sweep gives,
// into arrays of the result.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/base/vec.h"
#include "core/volume/fixed_point_sums.h"
#include "core/volume/near_field.h"
#include "core/volume/sweep_reader.h"
#include "core/volume/transmittance.h"

namespace hairbake {

/// The input of a functional. Refers to its parts, which must outlive the functional.
struct FunctionalInput {
    const TransmittanceScene& scene;
    const TransmittanceSettings& settings;
    std::span<const Vec3d> directions;
    const PointSet& vertices;            ///< of the hair, in the order of SortedStrands::vertices
    const PointSet* receiver = nullptr;  ///< the positions of scene.receiver with its normals; null without a receiver
};

/// The steps are called once each, in this order: reader, near_field_means, answer.
class Functional {
public:
    virtual ~Functional() = default;

    virtual const SweepReader& reader() const = 0;

    /// Mean values of T at the hair's vertices that the near field shall correct: [means][V], in the order of
    /// SortedStrands. All functionals share one pass over the near geometry. Default: none.
    virtual std::vector<std::vector<AngularMean>> near_field_means(const FixedPointSums& /*sums*/) const { return {}; }

    /// Puts the arrays into `result`. `corrected`: [means][V], the averages of near_field_means after the correction,
    /// in the model's order; may be moved from.
    virtual void answer(const FixedPointSums& sums, std::span<std::vector<float>> corrected,
                        Transmittance& result) const = 0;
};

/// Makes the functional, or returns null where the request does not want it.
using MakeFunctional = std::unique_ptr<Functional> (*)(const FunctionalInput& input);

}  // namespace hairbake
