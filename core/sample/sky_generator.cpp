#include "core/sample/sky_generator.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/base/random.h"
#include "core/environment/latlong.h"

namespace hairbake {

using std::numbers::pi;

namespace {

double smoothstep(double low, double high, double x) {
    const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}
Vec3d mix(const Vec3d& a, const Vec3d& b, double f) { return a * (1 - f) + b * f; }

// Smooth value noise in space, in [0, 1]: random numbers on a lattice, blended.
class Noise {
public:
    explicit Noise(std::uint64_t seed) : seed_(seed) {}

    /// Five octaves; most values lie in 0.3 to 0.7.
    double clouds(Vec3d p) const {
        double sum = 0, weight = 0.5;
        for (int octave = 0; octave < 5; ++octave, weight /= 2) {
            sum += weight * at(p);
            p = p * 2.03 + Vec3d(17.3);
        }
        return sum / (1 - 1.0 / 32);
    }

private:
    double corner(std::int64_t x, std::int64_t y, std::int64_t z) const {
        const auto mixed = static_cast<std::uint64_t>((x * 73856093) ^ (y * 19349663) ^ (z * 83492791));
        return Random(seed_ ^ mixed).next();
    }
    static std::int64_t below(double v) {
        const auto truncated = static_cast<std::int64_t>(v);
        return truncated - (v < static_cast<double>(truncated));
    }
    static double ease(double t) { return t * t * (3 - 2 * t); }
    double at(const Vec3d& p) const {
        const std::int64_t x = below(p.x), y = below(p.y), z = below(p.z);
        const double u = ease(p.x - double(x)), v = ease(p.y - double(y)), w = ease(p.z - double(z));
        const auto blend = [](double a, double b, double f) { return a + (b - a) * f; };
        const auto edge = [&](int dy, int dz) {
            return blend(corner(x, y + dy, z + dz), corner(x + 1, y + dy, z + dz), u);
        };
        return blend(blend(edge(0, 0), edge(1, 0), v), blend(edge(0, 1), edge(1, 1), v), w);
    }
    std::uint64_t seed_;
};

// A rectangle or an ellipse of light on the plane that touches the sphere at `centre`.
struct Lamp {
    Vec3d centre, right, up;  // unit, orthogonal
    double half_width, half_height;
    bool round;
    Vec3d radiance;
};

Lamp make_lamp(double azimuth, double elevation, double width_deg, double height_deg, bool round, Vec3d radiance) {
    const double c = std::cos(elevation), s = std::sin(elevation);
    const Vec3d centre{c * std::cos(azimuth), s, c * std::sin(azimuth)};
    const Vec3d right{-std::sin(azimuth), 0, std::cos(azimuth)};
    const double scale = pi / 360;
    return {centre, right,   cross(centre, right), std::tan(width_deg * scale), std::tan(height_deg * scale),
            round,  radiance};
}

struct Scene {
    Sky sky;
    Noise noise;
    std::vector<Lamp> lamps;
    Vec3d sun{0, 1, 0};
};

Scene make_scene(Sky sky, std::uint64_t seed) {
    Random random(seed);
    Scene scene{sky, Noise(random.next_u64()), {}, {}};
    const double azimuth = random.next(-pi, pi), elevation = random.next(0.45, 1.0);
    if (sky == Sky::sunny)
        scene.lamps.push_back(make_lamp(azimuth, elevation, 0.53, 0.53, true, Vec3d{1.0, 0.92, 0.80} * 9e4));
    if (sky == Sky::studio) {
        const Vec3d tints[] = {{1.0, 0.95, 0.88}, {0.80, 0.90, 1.0}, {1.0, 0.75, 0.55}};
        for (int k = 0; k < 4; ++k) {
            const double width = random.next(2.0, 4.0), height = random.next(2.0, 5.0);
            const double around = azimuth + k * pi / 2 + random.next(-0.5, 0.5), above = random.next(0.0, 1.1);
            scene.lamps.push_back(make_lamp(around, above, width, height, k == 3, tints[k % 3] * random.next(60, 200)));
        }
    }
    if (!scene.lamps.empty()) scene.sun = scene.lamps[0].centre;
    return scene;
}

constexpr double haze = 0.01;  // the sine of elevation within which ground and sky blend

Vec3d ground(const Scene& scene, const Vec3d& d, const Vec3d& colour) {
    return d.y < haze ? colour * (0.5 + scene.noise.clouds(d * 9)) : Vec3d();
}

Vec3d sunny(const Scene& scene, const Vec3d& d) {
    const Vec3d below = ground(scene, d, {0.20, 0.17, 0.12});
    if (d.y <= -haze) return below;
    const double height = std::max(d.y, 0.0);
    Vec3d air = mix({0.75, 0.85, 0.95}, {0.12, 0.27, 0.65}, std::sqrt(height));
    const double to_sun = std::max(dot(d, scene.sun), 0.0);
    air += Vec3d{1.0, 0.9, 0.7} * (0.5 * std::pow(to_sun, 8) + 6 * std::pow(to_sun, 800));
    const Vec3d overhead = d * (1.5 / (height + 0.25));
    const double cover = smoothstep(0.50, 0.68, scene.noise.clouds(overhead));
    const Vec3d cloud = Vec3d{1.0, 1.0, 1.02} * (0.7 + 0.6 * std::pow(to_sun, 4));
    return mix(below, mix(air, cloud, 0.9 * cover), smoothstep(-haze, haze, d.y));
}

Vec3d overcast(const Scene& scene, const Vec3d& d) {
    const Vec3d below = ground(scene, d, {0.16, 0.15, 0.13});
    if (d.y <= -haze) return below;
    const double cie = (1 + 2 * std::max(d.y, 0.0)) / 3;
    const double thickness = scene.noise.clouds(d * (2.0 / (std::max(d.y, 0.0) + 0.3)));
    const Vec3d sky = Vec3d{0.95, 0.98, 1.04} * (1.3 * cie * (0.4 + 1.2 * thickness));
    return mix(below, sky, smoothstep(-haze, haze, d.y));
}

Vec3d studio(const Scene& scene, const Vec3d& d) {
    const double walls = 0.02 + 0.05 * scene.noise.clouds(d * 3);
    const Vec3d floor = Vec3d{0.10, 0.09, 0.08} * (0.5 + scene.noise.clouds(d * 12));
    Vec3d glow;
    for (const Lamp& lamp : scene.lamps)
        glow += lamp.radiance * (4e-4 * std::pow(std::max(dot(d, lamp.centre), 0.0), 40));
    return mix(floor, Vec3d{0.9, 0.95, 1.0} * walls, smoothstep(-0.55, -0.45, d.y)) + glow;
}

Vec3d background(const Scene& scene, const Vec3d& d) {
    switch (scene.sky) {
        case Sky::sunny:
            return sunny(scene, d);
        case Sky::studio:
            return studio(scene, d);
        case Sky::overcast:
            return overcast(scene, d);
    }
    return {};
}

// Cuts the lamp into small equal patches and adds the flux of each to its texel. So the total flux is the same at every
// size of the map.
void add_lamp(EnvironmentMap& map, const LatLongRows& rows, const Lamp& lamp) {
    const double texel = pi / map.height;
    const int steps =
        std::max(64, static_cast<int>(std::ceil(16 * std::max(lamp.half_width, lamp.half_height) / texel)));
    const double patch = 4 * lamp.half_width * lamp.half_height / (double(steps) * steps);
    for (int j = 0; j < steps; ++j)
        for (int i = 0; i < steps; ++i) {
            const double a = 2 * (i + 0.5) / steps - 1, b = 2 * (j + 0.5) / steps - 1;
            if (lamp.round && a * a + b * b > 1) continue;
            const double u = a * lamp.half_width, v = b * lamp.half_height;
            const Vec3d d = lamp.centre + lamp.right * u + lamp.up * v;
            const double solid_angle = patch / (dot(d, d) * length(d));
            const MapPoint p = point_of(map, d);
            const int x = std::min(static_cast<int>(p.x), map.width - 1),
                      y = std::min(static_cast<int>(p.y), map.height - 1);
            map.pixels[std::size_t(y) * map.width + x] += Vec3f(lamp.radiance * (solid_angle / rows.solid_angle[y]));
        }
}

}  // namespace

std::string_view name_of(Sky sky) {
    switch (sky) {
        case Sky::sunny:
            return "sunny";
        case Sky::studio:
            return "studio";
        case Sky::overcast:
            return "overcast";
    }
    return "unknown";
}

EnvironmentMap generate_sky(Sky sky, int width, std::uint64_t seed) {
    if (width < 16 || width > 4096 || width % 2 != 0)
        throw Error(ErrorKind::usage, "the width of a generated sky is " + std::to_string(width) +
                                          "; allowed are even numbers from 16 to 4096");
    EnvironmentMap map;
    map.width = width;
    map.height = width / 2;
    map.pixels.resize(std::size_t(map.width) * map.height);
    map.source_format = "generated";
    map.primaries = {"Rec.709", default_chromaticities()};
    const Scene scene = make_scene(sky, seed);
    const LatLongRows rows = latlong_rows(map.width, map.height);
    const LatLongColumns columns = latlong_columns(map.width);
    parallel_for(map.height, 8, [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin; y < end; ++y)
            for (int x = 0; x < map.width; ++x) {
                const double s = rows.sin_theta[y];
                const Vec3d d{s * columns.cos_phi[x], rows.cos_theta[y], s * columns.sin_phi[x]};  // convention gltf
                map.pixels[y * map.width + x] = Vec3f(background(scene, d));
            }
    });
    for (const Lamp& lamp : scene.lamps) add_lamp(map, rows, lamp);
    return map;
}

}  // namespace hairbake
