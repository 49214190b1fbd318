// Means of the transmittance over the hemisphere at every position of the receiver.
#include <string>

#include "core/visibility/hemisphere_means.h"
#include "core/volume/functionals.h"
#include "core/volume/hemisphere_reader.h"

namespace hairbake {
namespace {

/// The near field is left to the grid: a point of a surface has no strand of its own, and hair that grows from the
/// surface leaves it within a voxel.
class ReceiverHemisphere final : public Functional {
public:
    ReceiverHemisphere(const PointSet& receiver, std::span<const Vec3d> directions) : reader_(receiver, directions) {}

    const SweepReader& reader() const override { return reader_; }

    void answer(const FixedPointSums& sums, std::span<std::vector<float>> /*corrected*/,
                Transmittance& result) const override {
        std::size_t without_direction = 0;
        result.receiver.reserve(2 * sums.points());
        for (std::size_t p = 0; p < sums.points(); ++p) {
            const auto sum = sums.of(p);
            const HemisphereSums hemisphere{double(sum[0]), double(sum[1]), double(sum[2]), double(sum[3])};
            const auto means = hemisphere.means();
            result.receiver.insert(result.receiver.end(), means.begin(), means.end());
            without_direction += hemisphere.weight > 0 ? 0 : 1;
        }
        if (without_direction > 0)
            result.warnings.push_back(
                std::to_string(without_direction) +
                " of the receiver's points have no direction above their plane and count as not shadowed: "
                "ask for more directions (transmittance.directions)");
    }

private:
    HemisphereReader reader_;
};

}  // namespace

std::unique_ptr<Functional> make_receiver_hemisphere(const FunctionalInput& input) {
    if (!input.receiver) return nullptr;
    return std::make_unique<ReceiverHemisphere>(*input.receiver, input.directions);
}

}  // namespace hairbake
