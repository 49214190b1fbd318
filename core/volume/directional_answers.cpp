#include "core/volume/directional_answers.h"

#include <algorithm>
#include <array>

#include "core/base/parallel.h"
#include "core/visibility/hemisphere_means.h"

namespace hairbake {
namespace {

/// Means over directions of T times each weight, of one vertex.
using Moments = std::array<float, SweepDirection::most_weights>;

/// The moments of a vertex whose A the near-field correction changed to `average`.
void correct(Moments& moments, std::size_t count, float average) {
    const float swept = moments[0];
    const float share = swept > 0 ? average / swept : 0;
    moments[0] = average;
    for (std::size_t i = 1; i < count; ++i) moments[i] *= share;
}

}  // namespace

std::vector<AngularMean> angular_means(const ItemSums& vertices, std::size_t directions) {
    std::vector<AngularMean> means(vertices.items());
    const float unit = 1 / (vertices.scale() * static_cast<float>(directions));
    parallel_for(means.size(), 1 << 15, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
            const auto sum = vertices.of(v);
            const Vec3f slope{static_cast<float>(sum[1]), static_cast<float>(sum[2]), static_cast<float>(sum[3])};
            means[v] = {static_cast<float>(sum[0]) * unit, slope * (3 * unit)};
        }
    });
    return means;
}

DirectionalMeans directional_answers(const ItemSums& vertices, std::span<const std::uint32_t> vertices_of,
                                     std::vector<float> average, std::size_t directions, int sh_bands, bool bent_cone) {
    DirectionalMeans answers;
    answers.average = std::move(average);
    if (sh_bands == 0 && !bent_cone) return answers;
    const auto coefficients = static_cast<std::size_t>(sh_bands * sh_bands);
    const std::size_t count = DirectionMoments::count_for(sh_bands, bent_cone);
    answers.sh.resize(vertices.items() * coefficients);
    answers.bent_cone.resize(bent_cone ? vertices.items() * 4 : 0);
    const float unit = 1 / (vertices.scale() * static_cast<float>(directions));
    parallel_for(vertices.items(), 1 << 15, [&](std::size_t begin, std::size_t end) {
        Moments moments;
        for (std::size_t place = begin; place < end; ++place) {
            const std::uint32_t v = vertices_of[place];
            const auto sum = vertices.of(place);
            for (std::size_t i = 0; i < count; ++i) moments[i] = static_cast<float>(sum[i]) * unit;
            correct(moments, count, answers.average[v]);
            if (coefficients > 0) sh_of_moments(moments, std::span(answers.sh).subspan(v * coefficients, coefficients));
            if (!bent_cone) continue;
            const auto cone = bent_cone_of_moments(moments[0], {moments[1], moments[2], moments[3]});
            std::copy(cone.begin(), cone.end(), answers.bent_cone.begin() + 4 * std::ptrdiff_t{v});
        }
    });
    return answers;
}

std::vector<float> receiver_answers(const ItemSums& receivers, std::size_t* without_direction) {
    std::vector<float> answers;
    answers.reserve(2 * receivers.items());
    *without_direction = 0;
    for (std::size_t p = 0; p < receivers.items(); ++p) {
        const auto sum = receivers.of(p);
        const HemisphereSums sums{double(sum[0]), double(sum[1]), double(sum[2]), double(sum[3])};
        const auto means = sums.means();
        answers.insert(answers.end(), means.begin(), means.end());
        *without_direction += sums.weight > 0 ? 0 : 1;
    }
    return answers;
}

}  // namespace hairbake
