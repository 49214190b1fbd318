#include "core/volume/opacity_transmittance.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/base/short_number.h"
#include "core/visibility/direction_moments.h"
#include "core/visibility/direction_set.h"
#include "core/visibility/hemisphere_means.h"
#include "core/volume/grid_frame.h"
#include "core/volume/opacity_map.h"
#include "core/volume/opacity_view.h"

namespace hairbake {
namespace {

constexpr std::size_t kMostMaps = 16;                         ///< at the same time, whatever the machine
constexpr std::uint64_t kMapMemory = std::uint64_t{1} << 30;  ///< bytes for all maps; one map is always allowed
constexpr std::size_t kGrain = 8192;                          ///< points in a piece of work

void check(const TransmittanceScene& scene, const TransmittanceSettings& settings) {
    const auto check_range = [](const char* field, double value, double low, double high) {
        if (!(value >= low && value <= high))
            throw Error(ErrorKind::usage,
                        std::string(field) + " is " + short_number(value) + "; allowed is " + short_number(low) +
                            " to " + short_number(high),
                        field);
    };
    check_range("transmittance.opacity_maps.layers", settings.opacity_maps.layers, 1, 16);
    check_range("transmittance.opacity_maps.layer_spacing", settings.opacity_maps.layer_spacing, 1, 16);
    check_range("transmittance.opacity_maps.resolution", settings.opacity_maps.resolution, 16, 4096);
    if (scene.occluder)
        throw Error(ErrorKind::usage,
                    "the transmittance method opacity_maps takes no occluder, as published; leave it out or use the "
                    "method volume or trace",
                    "occluder");
}

/// The smallest side of a texel: a smaller one would be narrower than hair.
/// Throws Error(bad_input) for widths that floats cannot hold.
double least_texel(const StrandGeometry& strands) {
    const double least = 2 * typical_largest_width(strands.widths);
    const double largest = *std::max_element(strands.widths.begin(), strands.widths.end());
    if (!(least > 1e-30 && least < 1e30) || largest > 1e6 * least)
        throw Error(ErrorKind::bad_input,
                    "the strands' widths have the 95th percentile " + std::to_string(least / 2) + " and the largest " +
                        std::to_string(largest) +
                        "; opacity maps take 5e-31 to 5e29, and at most two million times as much for the largest",
                    "strand.width");
    return least;
}

/// Map and results of one direction. Reused from direction to direction.
struct OneDirection {
    OpacityView view;
    std::vector<LightPoint> points;  ///< [V]
    OpacityMap map;
    std::vector<float> vertices, receiver;  ///< T, [V] and [R]
};

void evaluate(const TransmittanceScene& scene, const TransmittanceSettings& settings, const Vec3d& l, double least,
              Progress& progress, OneDirection& one) {
    const StrandGeometry& strands = scene.strands;
    one.view = make_opacity_view(strands.positions, l, settings.opacity_maps, least);
    one.points.resize(strands.vertex_count());
    parallel_for(one.points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) one.points[v] = one.view.project(strands.positions[v]);
    });
    one.map.draw(one.view, strands, one.points, progress);
    one.vertices.resize(one.points.size());
    parallel_for(one.points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        progress.check();
        for (std::size_t v = begin; v < end; ++v)
            one.vertices[v] = std::exp(-one.map.optical_depth(strands, one.points, static_cast<std::uint32_t>(v)));
    });
    if (!scene.receiver) return;
    const auto& positions = scene.receiver->positions;
    one.receiver.resize(positions.size());
    parallel_for(positions.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        progress.check();
        for (std::size_t r = begin; r < end; ++r)
            one.receiver[r] = std::exp(-one.map.optical_depth(one.view.project(positions[r])));
    });
}

/// Sums over the directions, added in their order.
class Sums {
public:
    Sums(const TransmittanceScene& scene, const TransmittanceSettings& settings, std::span<const Vec3d> directions)
        : receiver_(scene.receiver),
          directions_(directions),
          vertices_(scene.strands.vertex_count(), directions, settings.sh_bands, settings.bent_cone),
          hemispheres_(receiver_ ? receiver_->positions.size() : 0) {}

    void add(std::size_t direction, const OneDirection& one) {
        parallel_for(one.vertices.size(), kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t v = begin; v < end; ++v) vertices_.add(v, direction, one.vertices[v]);
        });
        parallel_for(hemispheres_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t r = begin; r < end; ++r)
                hemispheres_[r].add(one.receiver[r], dot(Vec3d(receiver_->normals[r]), directions_[direction]));
        });
    }

    void answer(Transmittance& result) const {
        DirectionalMeans means = vertices_.means();
        result.average = std::move(means.average);
        result.sh = std::move(means.sh);
        result.bent_cone = std::move(means.bent_cone);
        for (const HemisphereSums& sums : hemispheres_)
            for (const float mean : sums.means()) result.receiver.push_back(mean);
    }

private:
    const TriangleMesh* receiver_;
    std::span<const Vec3d> directions_;
    DirectionalSums vertices_;
    std::vector<HemisphereSums> hemispheres_;
};

std::size_t maps_at_once(const TransmittanceScene& scene, const TransmittanceSettings& settings) {
    const std::uint64_t receivers = scene.receiver ? scene.receiver->positions.size() : 0;
    const std::uint64_t each = OpacityMap::bytes(settings.opacity_maps) +
                               scene.strands.vertex_count() * (sizeof(LightPoint) + sizeof(float)) +
                               receivers * sizeof(float);
    const auto fitting = static_cast<std::size_t>(std::max<std::uint64_t>(1, kMapMemory / each));
    return std::min({fitting, kMostMaps, static_cast<std::size_t>(thread_count())});
}

}  // namespace

Transmittance bake_transmittance_opacity_maps(const TransmittanceScene& scene, const TransmittanceSettings& settings,
                                              Progress& progress) {
    check(scene, settings);
    const auto directions = make_directions(settings.direction_set, settings.directions, settings.seed);
    Transmittance result;
    result.directions = settings.directions;
    if (scene.strands.vertex_count() == 0) {
        if (scene.receiver) result.receiver.assign(2 * scene.receiver->positions.size(), 1);
        return result;
    }
    const double least = least_texel(scene.strands);
    Sums sums(scene, settings, directions);
    std::vector<OneDirection> slots(maps_at_once(scene, settings));
    bool bounded_by_width = false;
    for (std::size_t first = 0; first < directions.size(); first += slots.size()) {
        const std::size_t count = std::min(slots.size(), directions.size() - first);
        parallel_for(count, 1, [&](std::size_t k, std::size_t) {
            evaluate(scene, settings, directions[first + k], least, progress, slots[k]);
        });
        for (std::size_t k = 0; k < count; ++k) {
            sums.add(first + k, slots[k]);
            bounded_by_width = bounded_by_width || slots[k].view.texel_size == least;
        }
        progress.report(static_cast<double>(first + count) / static_cast<double>(directions.size()));
    }
    if (bounded_by_width)
        result.warnings.push_back(
            "the strands are too wide for the texels asked for: in some directions a texel is twice the 95th "
            "percentile of the widths, " +
            std::to_string(least) + " model units");
    sums.answer(result);
    return result;
}

}  // namespace hairbake
