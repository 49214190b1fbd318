#include "core/sample/groom_generator.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/base/random.h"
#include "core/sample/head_shape.h"
#include "core/sample/strand_growth.h"

namespace hairbake {
namespace {

void check(bool ok, const std::string& field, std::uint64_t found, const std::string& allowed) {
    if (!ok) throw Error(ErrorKind::usage, field + " is " + std::to_string(found) + "; allowed are " + allowed, field);
}

/// First point of each strand. Strands get equal shares; the remainder is spread evenly, one vertex a strand.
std::vector<std::uint32_t> share_out(std::uint64_t vertices, std::uint64_t per_strand) {
    const std::uint64_t strands = vertices == 0 ? 0 : std::max<std::uint64_t>(1, vertices / per_strand);
    std::vector<std::uint32_t> begin(strands + 1, 0);
    for (std::uint64_t s = 0; s <= strands && strands > 0; ++s)
        begin[s] = static_cast<std::uint32_t>(vertices / strands * s + vertices % strands * s / strands);
    return begin;
}

/// Directions of `count` different roots, spread evenly over the scalp. They are the accepted points of the
/// two-dimensional golden sequence (steps 1/g and 1/g^2 with g^3 = g + 1), shifted by the seed.
std::vector<Vec3d> place_roots(std::size_t count, std::uint64_t seed) {
    constexpr double g = 1.32471795724474602596;
    Random random = stream_of(seed, 0, 0);
    double u = random.next(), v = random.next();
    std::vector<Vec3d> roots;
    roots.reserve(count);
    while (roots.size() < count) {
        u += 1 / g;
        v += 1 / (g * g);
        u -= std::floor(u);
        v -= std::floor(v);
        const double y = 1 - 1.6 * u, azimuth = 2 * std::numbers::pi * v;  // y > -0.6 holds all of the scalp
        const double across = std::sqrt(1 - y * y);
        const Vec3d direction(across * std::sin(azimuth), y, across * std::cos(azimuth));
        if (!is_scalp(direction)) continue;
        // The area of a patch grows with the squared radius, so fewer points are accepted where the head is narrow.
        const double radius = head_radius(direction);
        if (random.next() * 110 > radius * radius) continue;
        roots.push_back(direction);
    }
    return roots;
}

}  // namespace

std::string description_of(const GroomSettings& settings) {
    return "hairbake sample groom, " + std::string(name_of(settings.style)) + ", seed " +
           std::to_string(settings.seed) + ", cm, Y up";
}

GroomSettings paper_model(int number) {
    switch (number) {
        case 1:
            return {GroomStyle::straight, 1'519'823, 30, 1};
        case 2:
            return {GroomStyle::wavy, 687'532, 30, 2};
        case 3:
            return {GroomStyle::curly, 1'031'268, 48, 3};
        case 4:
            return {GroomStyle::wavy, 872'756, 40, 4};
    }
    throw Error(ErrorKind::usage, "paper-model is " + std::to_string(number) + "; allowed are 1 to 4", "paper-model");
}

HairModel generate_groom(const GroomSettings& settings) {
    check(settings.vertices <= 1'000'000'000, "vertices", settings.vertices, "0 to 1,000,000,000");
    check(settings.vertices_per_strand >= 2 && settings.vertices_per_strand <= 65535, "vertices_per_strand",
          settings.vertices_per_strand, "2 to 65,535");

    HairModel model;
    model.default_thickness = root_width_cm;  // for the file's header: the model has a thickness array
    model.default_color = {0.32f, 0.2f, 0.12f};
    model.strand_begin = share_out(settings.vertices, settings.vertices_per_strand);
    const std::vector<Vec3d> roots = place_roots(model.strand_count(), settings.seed);
    model.positions.resize(settings.vertices);
    model.thickness.resize(settings.vertices);
    parallel_for(model.strand_count(), 64, [&](std::size_t first, std::size_t last) {
        for (std::size_t s = first; s < last; ++s) {
            const std::uint32_t begin = model.strand_begin[s], count = model.strand_begin[s + 1] - begin;
            grow_strand(settings.style, settings.seed, s, roots[s], std::span(&model.positions[begin], count),
                        std::span(&model.thickness[begin], count));
        }
    });
    return model;
}

}  // namespace hairbake
