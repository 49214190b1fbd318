#include "core/environment/light_clusters.h"

#include <algorithm>
#include <cstdint>

#include "core/base/luminance.h"
#include "core/base/parallel.h"
#include "core/base/random.h"

namespace hairbake {
namespace {

constexpr double share_of_flux = 0.85;
constexpr int most_rounds = 24;
constexpr std::uint64_t seed = 1;

struct Members {
    std::vector<Vec3d> direction, flux;
    std::vector<double> weight;  ///< sums to 1

    std::size_t size() const { return weight.size(); }
};

Members members_of(const LightSet& lights) {
    Members members;
    double all = 0;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        members.direction.push_back(normalized(Vec3d(lights.x[i], lights.y[i], lights.z[i])));
        members.flux.emplace_back(lights.flux[4 * i], lights.flux[4 * i + 1], lights.flux[4 * i + 2]);
        all += luminance(members.flux.back());
    }
    const auto count = static_cast<double>(lights.size());
    for (const Vec3d& flux : members.flux)
        members.weight.push_back((1 - share_of_flux) / count + (all > 0 ? share_of_flux * luminance(flux) / all : 0));
    return members;
}

/// Squared chord between two unit vectors.
double distance2(const Vec3d& a, const Vec3d& b) { return std::max(0.0, 2 - 2 * dot(a, b)); }

/// The first centre is the heaviest member; the next ones are drawn with the probability weight * squared distance to
/// the nearest centre so far.
std::vector<Vec3d> first_centres(const Members& members, std::size_t count, const Progress& progress) {
    Random random(seed);
    std::vector<double> nearest(members.size(), 4);
    const auto heaviest = std::max_element(members.weight.begin(), members.weight.end()) - members.weight.begin();
    std::vector<Vec3d> centres{members.direction[static_cast<std::size_t>(heaviest)]};
    while (centres.size() < count) {
        progress.check();
        double sum = 0;
        for (std::size_t i = 0; i < members.size(); ++i) {
            nearest[i] = std::min(nearest[i], distance2(members.direction[i], centres.back()));
            sum += members.weight[i] * nearest[i];
        }
        if (!(sum > 0)) break;  // every member is a centre
        double left = random.next() * sum;
        std::size_t drawn = 0;
        for (std::size_t i = 0; i < members.size(); ++i) {
            if (!(members.weight[i] * nearest[i] > 0)) continue;
            drawn = i;
            left -= members.weight[i] * nearest[i];
            if (left < 0) break;
        }
        centres.push_back(members.direction[drawn]);
    }
    return centres;
}

/// Sets owner[i] to the nearest centre of each member, the first of equals. Returns whether one has changed.
bool assign(const Members& members, const std::vector<Vec3d>& centres, std::vector<std::uint32_t>& owner) {
    std::vector<std::uint8_t> changed(members.size());
    parallel_for(members.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            std::size_t best = 0;
            double most = -2;
            for (std::size_t k = 0; k < centres.size(); ++k)
                if (const double cosine = dot(members.direction[i], centres[k]); cosine > most) {
                    most = cosine;
                    best = k;
                }
            changed[i] = owner[i] != best;
            owner[i] = static_cast<std::uint32_t>(best);
        }
    });
    return std::any_of(changed.begin(), changed.end(), [](std::uint8_t c) { return c != 0; });
}

/// Moves each centre to the weighted mean of its members; one whose members cancel out stays.
void move_centres(const Members& members, const std::vector<std::uint32_t>& owner, std::vector<Vec3d>& centres) {
    std::vector<Vec3d> sums(centres.size());
    for (std::size_t i = 0; i < members.size(); ++i) sums[owner[i]] += members.direction[i] * members.weight[i];
    for (std::size_t k = 0; k < centres.size(); ++k)
        if (length(sums[k]) > 1e-12) centres[k] = normalized(sums[k]);
}

}  // namespace

std::vector<ClusteredLight> cluster_lights(const LightSet& lights, std::size_t count, const Progress& progress) {
    const Members members = members_of(lights);
    std::vector<ClusteredLight> clusters;
    if (members.size() <= count) {
        for (std::size_t i = 0; i < members.size(); ++i) clusters.push_back({members.direction[i], members.flux[i]});
        return clusters;
    }
    std::vector<Vec3d> centres = first_centres(members, count, progress);
    std::vector<std::uint32_t> owner(members.size(), ~0u);
    for (int round = 0; round < most_rounds && assign(members, centres, owner); ++round) {
        progress.check();
        move_centres(members, owner, centres);
    }
    for (const Vec3d& centre : centres) clusters.push_back({centre, Vec3d()});
    for (std::size_t i = 0; i < members.size(); ++i) clusters[owner[i]].flux += members.flux[i];
    return clusters;
}

std::vector<ClusteredLight> as_clusters(const std::vector<DirectionalLight>& lights) {
    std::vector<ClusteredLight> clusters;
    for (const DirectionalLight& light : lights) clusters.push_back({normalized(light.direction), light.irradiance});
    return clusters;
}

}  // namespace hairbake
