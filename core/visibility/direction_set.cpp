#include "core/visibility/direction_set.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/base/error.h"
#include "core/base/random.h"

namespace hairbake {
namespace {

Vec3d from_y_and_azimuth(double y, double phi) {
    const double radius = std::sqrt(std::max(0.0, 1 - y * y));
    return {radius * std::cos(phi), y, radius * std::sin(phi)};
}

std::vector<Vec3d> fibonacci(int count) {
    std::vector<Vec3d> directions;
    directions.reserve(static_cast<std::size_t>(count));
    const double golden_angle = std::numbers::pi * (3 - std::sqrt(5.0));
    for (int k = 0; k < count; ++k)
        directions.push_back(from_y_and_azimuth(1 - (2 * k + 1) / double(count), k * golden_angle));
    return directions;
}

std::vector<Vec3d> stratified(int count, std::uint64_t seed) {
    const int side = static_cast<int>(std::lround(std::sqrt(double(count))));
    if (side * side != count)
        throw Error(ErrorKind::usage,
                    "transmittance.directions is " + std::to_string(count) +
                        "; allowed are square numbers (9, 25, 64, 100, ...) with the stratified set",
                    "transmittance.directions");
    Random random(seed);
    std::vector<Vec3d> directions;
    for (int row = 0; row < side; ++row)
        for (int column = 0; column < side; ++column) {
            const double y = 1 - 2 * (row + random.next()) / side;
            directions.push_back(from_y_and_azimuth(y, 2 * std::numbers::pi * (column + random.next()) / side));
        }
    return directions;
}

std::vector<Vec3d> independent(int count, std::uint64_t seed) {
    Random random(seed);
    std::vector<Vec3d> directions;
    for (int k = 0; k < count; ++k) {
        const double y = 1 - 2 * random.next();
        directions.push_back(from_y_and_azimuth(y, 2 * std::numbers::pi * random.next()));
    }
    return directions;
}

}  // namespace

std::string_view name_of(DirectionSet set) {
    switch (set) {
        case DirectionSet::fibonacci:
            return "fibonacci";
        case DirectionSet::stratified:
            return "stratified";
        case DirectionSet::random:
            return "random";
    }
    return "unknown";
}

std::vector<Vec3d> make_directions(DirectionSet set, int count, std::uint64_t seed) {
    if (count < 1 || count > 4096)
        throw Error(ErrorKind::usage,
                    "transmittance.directions is " + std::to_string(count) + "; allowed are 1 to 4096",
                    "transmittance.directions");
    switch (set) {
        case DirectionSet::fibonacci:
            return fibonacci(count);
        case DirectionSet::stratified:
            return stratified(count, seed);
        case DirectionSet::random:
            return independent(count, seed);
    }
    throw Error(ErrorKind::internal, "unknown direction set");
}

}  // namespace hairbake
