#include "core/volume/own_shadow.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/visibility/direction_set.h"
#include "core/volume/extinction_bricks.h"

namespace hairbake {
namespace {

constexpr float reach_along = 3;     // voxels of arc on each side of the vertex
constexpr int most_segments = 1024;  // on each side: so the work stays linear, however many points a voxel has
constexpr float shortest = 0.125f;   // voxels; shorter pieces are taken together
/// Half of the variance of the own strand's depth over directions, divided by its squared mean: the mean of exp(-depth)
/// is exp(-(mean - variance / 2)). tests/core/volume/lone_strands_test.cpp checks it.
constexpr float half_variance = 0.12f;

std::size_t index_of(int i, int j, int k) { return static_cast<std::size_t>((i + 2) * 25 + (j + 2) * 5 + (k + 2)); }

/// The n-th point of the additive sequence with the ratios of the generalised golden section in five dimensions.
std::array<double, 5> place_of(int n) {
    constexpr double ratios[5] = {0.8566748838545029, 0.7338918566271260, 0.6287067210378087, 0.5385972572236101,
                                  0.4614027427763899};
    std::array<double, 5> place;
    for (std::size_t i = 0; i < 5; ++i) {
        const double sum = 0.5 + n * ratios[i];
        place[i] = sum - std::floor(sum);
    }
    return place;
}

}  // namespace

/// Sums of one cell.
struct OwnShadow::Samples {
    double depth = 0;
    Vec3d direction;
    std::array<double, 6> square{};

    void add(double weight, const Vec3d& l) {
        depth += weight;
        direction += l * weight;
        const double products[6] = {l.x * l.x, l.y * l.y, l.z * l.z, l.x * l.y, l.x * l.z, l.y * l.z};
        for (std::size_t i = 0; i < 6; ++i) square[i] += weight * products[i];
    }
    Cell cell(double count) const {
        Cell cell;
        if (!(depth > 0)) return cell;
        cell.depth = static_cast<float>(depth / count);
        cell.direction = Vec3f(direction / depth);
        for (std::size_t i = 0; i < 6; ++i) cell.square[i] = static_cast<float>(square[i] / depth);
        return cell;
    }
};

OwnShadow::OwnShadow() {
    constexpr int rounds = 4, distinct = 4096, count = rounds * distinct;  // samples of each place
    const auto directions = make_directions(DirectionSet::fibonacci, distinct, 0);
    for (int place = 0; place < places * places * places; ++place) {
        std::array<Samples, offsets> sums{};
        const int corner[3] = {place / (places * places), place / places % places, place % places};
        for (int n = 0; n < count; ++n) {
            const Vec3d& l = directions[static_cast<std::size_t>(n % distinct)];
            const std::array<double, 5> random = place_of(n);
            double p[3], shift[3];  // of the vertex in its voxel, and of the ray that it reads
            for (int a = 0; a < 3; ++a) p[a] = (corner[a] + random[static_cast<std::size_t>(a)]) / (2 * places);
            const double slope[3] = {l.x, l.y, l.z};
            int m = 0;
            for (int a = 1; a < 3; ++a)
                if (std::abs(slope[a]) > std::abs(slope[m])) m = a;
            for (int a = 0, next = 3; a < 3; ++a)
                shift[a] = a == m ? 0 : random[static_cast<std::size_t>(next++)] - 0.5;
            const double length = 1 / std::abs(slope[m]);  // of a ray in a slice
            const bool up = slope[m] > 0;
            sums[index_of(0, 0, 0)].add((up ? 1 - p[m] : p[m]) * length, l);
            for (int k = 1; k <= reach; ++k) {
                const double t = ((up ? k + 0.5 : 0.5 - k) - p[m]) / slope[m];
                int o[3];
                for (int a = 0; a < 3; ++a) o[a] = static_cast<int>(std::floor(p[a] + shift[a] + t * slope[a]));
                o[m] = up ? k : -k;
                if (*std::max_element(o, o + 3) <= reach && *std::min_element(o, o + 3) >= -reach)
                    sums[index_of(o[0], o[1], o[2])].add(length, l);
            }
        }
        for (const Samples& sum : sums) cells_.push_back(sum.cell(count));
    }
}

/// The table of a vertex's place. The table is of the lower half of the voxel on each axis; `mirror` is -1 on the axes
/// on which the vertex is in the upper half.
struct OwnShadow::View {
    const Cell* cells;
    int voxel[3];
    Vec3f mirror;
    const NearFieldWindow& window;
};

void OwnShadow::add_piece(const View& view, const Vec3f& centre, const Vec3f& axis, float mass,
                          std::span<const Vec3f> slopes, std::span<Depth> depths) const {
    const int i = static_cast<int>(std::floor(centre.x)) - view.voxel[0];
    const int j = static_cast<int>(std::floor(centre.y)) - view.voxel[1];
    const int k = static_cast<int>(std::floor(centre.z)) - view.voxel[2];
    if (std::max({std::abs(i), std::abs(j), std::abs(k)}) > reach) return;
    const auto flipped = [](int o, float sign) { return sign < 0 ? -o : o; };
    const std::size_t at = index_of(flipped(i, view.mirror.x), flipped(j, view.mirror.y), flipped(k, view.mirror.z));
    const Cell& cell = view.cells[at];
    const Vec3f t(axis.x * view.mirror.x, axis.y * view.mirror.y, axis.z * view.mirror.z);
    const auto& q = cell.square;
    const float cosine2 = q[0] * t.x * t.x + q[1] * t.y * t.y + q[2] * t.z * t.z +
                          2 * (q[3] * t.x * t.y + q[4] * t.x * t.z + q[5] * t.y * t.z);
    const bool own_voxel = i == 0 && j == 0 && k == 0;
    const float sine = std::sqrt(std::max(0.0f, 1 - cosine2)) * (own_voxel ? isotropic_sine : 1);
    const float swept = mass * cell.depth * sine;
    const Vec3f mean(cell.direction.x * view.mirror.x, cell.direction.y * view.mirror.y,
                     cell.direction.z * view.mirror.z);
    for (std::size_t m = 0; m < slopes.size(); ++m) depths[m].swept += swept * std::max(0.0f, 1 + dot(slopes[m], mean));
    if (std::max({std::abs(i), std::abs(j), std::abs(k)}) > 1) return;
    const NearFieldWindow& window = view.window;
    const auto o = static_cast<std::size_t>(9 * (i + 1) + 3 * (j + 1) + (k + 1));
    const Vec3f toward(window.direction_x[o], window.direction_y[o], window.direction_z[o]);
    const float across = std::sqrt(std::max(0.0f, 1 - dot(toward, axis) * dot(toward, axis)));
    const float seen = mass * window.weight[o] * across / (4 * std::numbers::pi_v<float>);
    for (std::size_t m = 0; m < slopes.size(); ++m)
        depths[m].in_window += seen * std::max(0.0f, 1 + dot(slopes[m], toward));
}

void OwnShadow::depths(const StrandGeometry& strands, const GridFrame& frame, const NearFieldWindow& window,
                       std::uint32_t v, std::span<const Vec3f> slopes, std::span<Depth> depths) const {
    std::fill(depths.begin(), depths.end(), Depth{});
    const Vec3f x = frame.to_grid(strands.positions[v]);
    View view{cells_.data(), {int(std::floor(x.x)), int(std::floor(x.y)), int(std::floor(x.z))}, {}, window};
    const auto half = [](float inside, float& mirror) {
        mirror = inside < 0.5f ? 1.0f : -1.0f;
        return std::min(places - 1, static_cast<int>(2 * places * (inside < 0.5f ? inside : 1 - inside)));
    };
    const int place[3] = {half(x.x - float(view.voxel[0]), view.mirror.x),
                          half(x.y - float(view.voxel[1]), view.mirror.y),
                          half(x.z - float(view.voxel[2]), view.mirror.z)};
    view.cells += offsets * ((place[0] * places + place[1]) * places + place[2]);
    const auto inverse_h = static_cast<float>(1 / frame.voxel_size);
    for (const int way : {1, -1}) {
        Vec3f begin = x;
        float arc = 0, mass = 0;  // of the pieces since `begin`
        int walked = 0;           // segments
        for (std::uint32_t from = v; arc < reach_along; from += static_cast<std::uint32_t>(way)) {
            if (walked++ == most_segments || (way < 0 && from == 0)) break;
            const std::uint32_t segment = way > 0 ? from : from - 1;
            if (strands.segments[segment] == Segment::none) break;
            if (strands.segments[segment] != Segment::solid) continue;
            const Vec3f end = frame.to_grid(strands.positions[segment + (way > 0 ? 1 : 0)]);
            const Vec3f whole = end - begin;
            const float opacity = 0.5f * (strands.opacities[segment] + strands.opacities[segment + 1]);
            const float g = opacity * 0.5f * (strands.widths[segment] + strands.widths[segment + 1]) * inverse_h;
            const float span = length(whole);
            mass += deposited_weight(g) * length(end - frame.to_grid(strands.positions[segment + (way > 0 ? 0 : 1)]));
            if (span < shortest) continue;
            const int parts = std::max(1, static_cast<int>(std::ceil(span)));
            const Vec3f step = whole / static_cast<float>(parts), axis = whole / span;
            for (int part = 0; part < parts && arc < reach_along; ++part) {
                add_piece(view, begin + (static_cast<float>(part) + 0.5f) * step, axis,
                          mass / static_cast<float>(parts), slopes, depths);
                arc += span / static_cast<float>(parts);
            }
            begin = end;
            mass = 0;
        }
    }
    for (Depth& depth : depths) depth.swept -= half_variance * depth.swept * depth.swept;
}

}  // namespace hairbake
