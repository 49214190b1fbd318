#include "core/visibility/direction_moments.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/assert.h"
#include "core/base/parallel.h"
#include "core/base/spherical_harmonics.h"

namespace hairbake {

using std::numbers::pi;

std::size_t DirectionMoments::count_for(int sh_bands, bool bent_cone) {
    const int bands = std::max({sh_bands, bent_cone ? 2 : 1, 1});
    return static_cast<std::size_t>(bands) * static_cast<std::size_t>(bands);
}

DirectionMoments::DirectionMoments(std::span<const Vec3d> directions, int sh_bands, bool bent_cone)
    : directions_(directions.size()), count_(count_for(sh_bands, bent_cone)) {
    HAIRBAKE_ASSERT(sh_bands >= 0 && sh_bands <= 4);
    const ShBasis basis(4);
    std::vector<double> y(static_cast<std::size_t>(basis.count()));
    for (const Vec3d& w : directions) {
        basis.evaluate(w, y);
        y[0] = 1;
        y[1] = w.x;
        y[2] = w.y;
        y[3] = w.z;
        weights_.insert(weights_.end(), y.begin(), y.begin() + static_cast<std::ptrdiff_t>(count_));
    }
}

void sh_of_moments(std::span<const float> moments, std::span<float> sh) {
    HAIRBAKE_ASSERT(!sh.empty() && sh.size() <= 16 && moments.size() >= sh.size());
    const auto zeroth = static_cast<float>(2 * std::sqrt(pi)), first = static_cast<float>(2 * std::sqrt(3 * pi));
    sh[0] = zeroth * moments[0];
    if (sh.size() < 4) return;
    // Y_1 = sqrt(3 / (4 pi)) (y, z, x)
    sh[1] = first * moments[2];
    sh[2] = first * moments[3];
    sh[3] = first * moments[1];
    for (std::size_t i = 4; i < sh.size(); ++i) sh[i] = static_cast<float>(4 * pi) * moments[i];
}

std::array<float, 4> bent_cone_of_moments(float average, const Vec3f& mean_t_w) {
    constexpr float all = 1 - 0x1p-20f;
    if (average >= all) return {0, 0, 0, std::numbers::pi_v<float>};
    if (!(average > 0)) return {0, 0, 0, 0};
    const Vec3d b = Vec3d(mean_t_w) / double(average);
    const double size = length(b);
    const Vec3f axis = size > 0 ? Vec3f(b / size) : Vec3f();
    return {axis.x, axis.y, axis.z, static_cast<float>(std::acos(std::clamp(2 * size - 1, -1.0, 1.0)))};
}

DirectionalSums::DirectionalSums(std::size_t points, std::span<const Vec3d> directions, int sh_bands, bool bent_cone)
    : moments_(directions, sh_bands, bent_cone),
      sh_bands_(sh_bands),
      bent_cone_(bent_cone),
      sums_(points * moments_.count()) {}

DirectionalMeans DirectionalSums::means() const {
    const std::size_t moments = moments_.count(), points = sums_.size() / moments;
    const auto bands = static_cast<std::size_t>(sh_bands_), coefficients = bands * bands;
    DirectionalMeans means;
    means.average.resize(points);
    means.sh.resize(points * coefficients);
    means.bent_cone.resize(bent_cone_ ? points * 4 : 0);
    parallel_for(points, 1 << 14, [&](std::size_t begin, std::size_t end) {
        std::vector<float> mean(moments);
        for (std::size_t p = begin; p < end; ++p) {
            for (std::size_t i = 0; i < moments; ++i)
                mean[i] = static_cast<float>(sums_[p * moments + i] / double(moments_.directions()));
            means.average[p] = mean[0];
            if (coefficients > 0) sh_of_moments(mean, std::span(means.sh).subspan(p * coefficients, coefficients));
            if (!bent_cone_) continue;
            const auto cone = bent_cone_of_moments(mean[0], {mean[1], mean[2], mean[3]});
            std::copy(cone.begin(), cone.end(), means.bent_cone.begin() + static_cast<std::ptrdiff_t>(4 * p));
        }
    });
    return means;
}

}  // namespace hairbake
