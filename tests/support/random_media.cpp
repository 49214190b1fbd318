#include "tests/support/random_media.h"

#include <cmath>

#include "core/visibility/direction_set.h"
#include "tests/support/analytic_media.h"

namespace hairbake::test_support {
namespace {

struct Optics {
    double extinction, outside;  ///< effective extinction, and the share of places outside every fibre
};

Optics optics(const Fibres& fibres, double mean_length, Truth truth) {
    if (truth == Truth::mean_field) return {fibres.extinction, 1};
    return {fibres.extinction * (1 + fibres.width / mean_length), std::exp(-fibres.extinction * fibres.width)};
}

/// Mean length of fibres cut off at a body's surface: of those that meet it, L V / (V + S L / 4).
double cut_length(double length, double volume_over_surface) { return length / (1 + length / 4 / volume_over_surface); }

double parallel_ball_transmittance(double extinction, const Vec3d& p) {
    static const auto directions = make_directions(DirectionSet::fibonacci, 4096, 0);
    const Body body = ball(1);
    double sum = 0;
    for (const Vec3d& l : directions)
        sum += std::exp(-extinction * std::sqrt(std::max(0.0, 1 - l.z * l.z)) * body(p, l).end);
    return sum / static_cast<double>(directions.size());
}

}  // namespace

Medium ball_medium(Random& random, const Fibres& fibres, double r, int probes, Truth truth) {
    Medium medium;
    fill(medium.model, ball(1), Vec3d(-1), Vec3d(1), fibres, random);
    std::vector<Vec3d> places;
    for (int k = 0; k < probes; ++k) places.push_back(random_direction(random) * r);
    medium.first_probe = medium.model.add_probes(places);
    const Optics o = optics(fibres, cut_length(fibres.length, 1.0 / 3), truth);
    medium.expected.assign(places.size(), o.outside * ball_transmittance(o.extinction, 1, r));
    return medium;
}

Medium parallel_ball_medium(Random& random, const Fibres& fibres, double r, int probes, Truth truth) {
    Medium medium;
    fill(medium.model, ball(1), Vec3d(-1), Vec3d(1), fibres, random);
    std::vector<Vec3d> places;
    for (int k = 0; k < probes; ++k) places.push_back(random_direction(random) * r);
    medium.first_probe = medium.model.add_probes(places);
    const double inside = truth == Truth::fibres ? std::numbers::pi / 4 * fibres.extinction * fibres.width : 0;
    for (const Vec3d& p : places)
        medium.expected.push_back(std::exp(-inside) * parallel_ball_transmittance(fibres.extinction, p));
    return medium;
}

Medium slab_medium(Random& random, const Fibres& fibres, double h, double width, double z, int probes, Truth truth) {
    Medium medium;
    const Vec3d low(-width / 2, -width / 2, 0), high(width / 2, width / 2, h);
    fill(medium.model, box(low, high), low, high, fibres, random);
    std::vector<Vec3d> places;
    for (int k = 0; k < probes; ++k) {
        const double x = random.next(-0.1, 0.1) * width, y = random.next(-0.1, 0.1) * width;
        places.push_back({x, y, z});
    }
    medium.first_probe = medium.model.add_probes(places);
    const double volume_over_surface = h * width * width / (2 * width * width + 4 * width * h);
    const Optics o = optics(fibres, cut_length(fibres.length, volume_over_surface), truth);
    medium.expected.assign(places.size(), o.outside * slab_transmittance(o.extinction, h, z));
    return medium;
}

MeanError mean_error(int realisations, const std::function<Medium(Random&)>& make,
                     const std::function<std::vector<float>(const Medium&)>& evaluate) {
    double sum = 0, sum2 = 0;
    for (int seed = 1; seed <= realisations; ++seed) {
        Random random(static_cast<std::uint64_t>(seed));
        const Medium medium = make(random);
        const auto a = evaluate(medium);
        double error = 0;
        for (std::size_t k = 0; k < a.size(); ++k)
            error += (double(a[k]) - medium.expected[k]) / static_cast<double>(a.size());
        sum += error;
        sum2 += error * error;
    }
    const double n = realisations, mean = sum / n;
    return {mean, std::sqrt(std::max(0.0, sum2 / n - mean * mean) / (n - 1))};
}

}  // namespace hairbake::test_support
