#include "core/sample/strand_growth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/sample/head_shape.h"

namespace hairbake {
namespace {

enum StreamKind : std::uint64_t { strand_stream = 1, clump_stream = 2 };
constexpr double clump_size = 0.9;  // cm between clumps: about fifty hairs in each of 50,000
constexpr double two_pi = 2 * std::numbers::pi;

/// The look of a style: a helix around the strand's path (flat for waves) and how strongly clumps draw together.
struct Look {
    double curl_radius, curl_pitch;  ///< cm
    double flatness;                 ///< 1: the helix is a plane wave, 0: round
    double clumping;                 ///< share of the way to the clump's guide at the tip
};

Look look_of(GroomStyle style) {
    switch (style) {
        case GroomStyle::straight:
            return {0.06, 9, 0.5, 0.35};
        case GroomStyle::wavy:
            return {0.3, 4.5, 0.85, 0.45};
        case GroomStyle::curly:
            return {0.4, 2.8, 0, 0.55};
    }
    return {};
}

/// The random properties of one strand or clump guide.
struct Character {
    double length;     ///< cm along the path
    double lift;       ///< cm above the skin where the strand comes to lie
    double stiffness;  ///< how slowly gravity bends it, in cm
    Vec3d lean;        ///< random tilt of the first direction
    double curl_phase, curl_radius, curl_pitch;
};

Character draw_character(const Look& look, Random random, const Vec3d& root) {
    Character c;
    // Hair from the crown lies over hair from the sides, so its layer is further out.
    c.lift = random.next(0.08, 0.5) + 0.9 * std::max(0.0, root.y) * random.next(0.5, 1);
    const double arc_length = random.next(14, 26) * random.next(0.9, 1.1);
    c.curl_radius = look.curl_radius * random.next(0.7, 1.3);
    c.curl_pitch = look.curl_pitch * random.next(0.85, 1.15);
    // A round helix is longer than its axis by this factor; a wave by about half of the excess.
    const double slope = two_pi * c.curl_radius / c.curl_pitch;
    c.length = arc_length / std::sqrt(1 + slope * slope * (1 - 0.5 * look.flatness));
    c.stiffness = random.next(1, 2.5);
    c.lean = Vec3d(random.next(-1, 1), random.next(-1, 1), random.next(-1, 1)) * 0.15;
    c.curl_phase = random.next(0, two_pi);
    return c;
}

/// Combed away from a parting in the middle, backwards and down, along the skin.
Vec3d comb_direction(const Vec3d& root, const Vec3d& normal) {
    const Vec3d wish(2.5 * root.x / (std::abs(root.x) + 0.3), -0.6, -0.9);
    return wish - normal * dot(wish, normal);
}

/// Moves `point` out along its ray to at least `height` above the head.
Vec3d lifted(const Vec3d& point, double height) {
    const double distance = length(point);
    const double least = head_radius(point / distance) + height;
    return distance >= least ? point : point * (least / distance);
}

/// The strand's path without curls: leaves the skin, bends under gravity, lies on the head or hangs.
void follow_path(const Character& c, const Vec3d& root, std::span<Vec3d> path) {
    const double step = path.size() > 1 ? c.length / static_cast<double>(path.size() - 1) : 0;
    const Vec3d normal = head_normal(root);
    Vec3d heading = normalized(normal + comb_direction(root, normal) * 0.9 + c.lean);
    path[0] = root * head_radius(root);
    for (std::size_t i = 1; i < path.size(); ++i) {
        heading = normalized(heading + Vec3d(0, -step / c.stiffness, 0));
        const double grown = step * static_cast<double>(i);
        const double height = c.lift * (1 - std::exp(-grown / 1.5));
        path[i] = lifted(path[i - 1] + heading * step, height);
        heading = normalized(path[i] - path[i - 1]);
    }
}

/// Direction of the clump that a root belongs to: the nearest of one random point in each cell of a grid.
struct Clump {
    Vec3d root;
    std::uint64_t id = 0;
};

Clump find_clump(std::uint64_t seed, const Vec3d& root_point) {
    const auto cell_of = [](double x) { return static_cast<std::int64_t>(std::floor(x / clump_size)); };
    Clump nearest;
    double best = 1e300;
    for (std::int64_t dx = -1; dx <= 1; ++dx)
        for (std::int64_t dy = -1; dy <= 1; ++dy)
            for (std::int64_t dz = -1; dz <= 1; ++dz) {
                const std::int64_t x = cell_of(root_point.x) + dx, y = cell_of(root_point.y) + dy,
                                   z = cell_of(root_point.z) + dz;
                const auto id = static_cast<std::uint64_t>(((x + 512) << 20) | ((y + 512) << 10) | (z + 512));
                Random random = stream_of(seed, clump_stream, id);
                const Vec3d point((static_cast<double>(x) + random.next()) * clump_size,
                                  (static_cast<double>(y) + random.next()) * clump_size,
                                  (static_cast<double>(z) + random.next()) * clump_size);
                const Vec3d offset = point - root_point;
                if (dot(offset, offset) < best) {
                    best = dot(offset, offset);
                    nearest = {normalized(point), id};
                }
            }
    return nearest;
}

/// Draws the path towards the clump's guide, more and more from root to tip. It draws less where the two part by more
/// than a few centimetres (on either side of the parting), because the blend would cross the head.
void draw_together(std::span<Vec3d> path, std::span<const Vec3d> guide, double share) {
    double apart = 0;
    for (std::size_t i = 0; i < path.size(); ++i) apart = std::max(apart, length(guide[i] - path[i]));
    share *= std::exp(-apart * apart / 9);
    for (std::size_t i = 1; i < path.size(); ++i) {
        const double along = static_cast<double>(i) / static_cast<double>(path.size() - 1);
        const double weight = share * along * along * (3 - 2 * along);
        path[i] += (guide[i] - path[i]) * weight;
    }
}

/// Winds the path into a helix or a wave whose radius grows from zero at the root.
void curl(const Character& c, double flatness, std::span<Vec3d> path) {
    Vec3d side = std::abs(path[0].x) < 5 ? Vec3d(1, 0, 0) : Vec3d(0, 0, 1);
    double grown = 0;
    Vec3d previous = path[0];
    for (std::size_t i = 1; i < path.size(); ++i) {
        const Vec3d here = path[i];
        grown += length(here - previous);
        const Vec3d along = normalized(here - previous);
        previous = here;
        side = normalized(side - along * dot(side, along));  // carried along without twist
        const double angle = two_pi * grown / c.curl_pitch + c.curl_phase;
        const double radius = c.curl_radius * (1 - std::exp(-grown / 2));
        path[i] = here + (side * std::cos(angle) + cross(along, side) * ((1 - flatness) * std::sin(angle))) * radius;
    }
}

/// Rounded outwards where a float would fall inside the head.
Vec3f to_float_outside(const Vec3d& point) {
    Vec3f p(point);
    for (double grow = 1e-7; height_above_head(Vec3d(p)) < 0; grow *= 2) p = Vec3f(point * (1 + grow));
    return p;
}

}  // namespace

void grow_strand(GroomStyle style, std::uint64_t seed, std::uint64_t index, const Vec3d& root, std::span<Vec3f> points,
                 std::span<float> widths) {
    const Look look = look_of(style);
    Random random = stream_of(seed, strand_stream, index);
    const Clump clump = find_clump(seed, root * head_radius(root));
    const Character guide_character = draw_character(look, stream_of(seed, clump_stream, ~clump.id), clump.root);
    Character character = draw_character(look, random, root);
    random = stream_of(seed, strand_stream, ~index);
    // Hairs of a clump wind together, with some play; one in thirty winds by itself.
    const bool flyaway = random.next() < 1.0 / 30;
    if (!flyaway) character.curl_phase = guide_character.curl_phase + random.next(-0.6, 0.6);
    if (!flyaway) character.curl_pitch = guide_character.curl_pitch;
    if (flyaway) character.lift *= 1.6;

    std::vector<Vec3d> path(points.size()), guide(points.size());
    follow_path(character, root, path);
    follow_path(guide_character, clump.root, guide);
    draw_together(path, guide, flyaway ? 0 : look.clumping * random.next(0.5, 1.5));
    curl(character, look.flatness, path);

    const double clearance = random.next(0.02, 0.2);
    const float width = root_width_cm * static_cast<float>(random.next(0.9, 1.1));
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double along = path.size() > 1 ? static_cast<double>(i) / static_cast<double>(path.size() - 1) : 0;
        const double height = clearance * std::min(1.0, 8 * along);
        points[i] = to_float_outside(i == 0 ? path[i] : lifted(path[i], height));
        widths[i] = width * static_cast<float>(1 - 0.4 * along);
    }
}

}  // namespace hairbake
