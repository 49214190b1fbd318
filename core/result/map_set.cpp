#include "core/result/map_set.h"

#include <algorithm>
#include <string_view>

namespace hairbake {
namespace {

/// theta'_m in degrees: m * 180 / M, for m = 0 .. M.
std::vector<double> theta_prime_degrees(std::size_t maps) {
    std::vector<double> angles;
    for (std::size_t m = 0; m < maps; ++m)
        angles.push_back(180.0 * static_cast<double>(m) / static_cast<double>(maps - 1));
    return angles;
}

}  // namespace

std::string MapLobe::file_name(std::size_t cube) const {
    if (cubes.size() == 1 && !has_slices()) return name;
    const std::string last = std::to_string(cubes.size() - 1);
    std::string number = std::to_string(cube);
    number.insert(0, std::max<std::size_t>(2, last.size()) - number.size(), '0');
    return name + "_" + number;
}

std::string MapLobe::label(std::size_t cube) const {
    return cubes.size() == 1 && !has_slices() ? name : name + " " + std::to_string(cube);
}

const MapLobe* MapSet::find(std::string_view name) const {
    for (const MapLobe& lobe : lobes)
        if (lobe.name == name) return &lobe;
    return nullptr;
}

std::size_t MapSet::cube_count() const {
    std::size_t count = 0;
    for (const MapLobe& lobe : lobes) count += lobe.cubes.size();
    return count;
}

double MapSet::parameter(std::string_view name) const {
    for (const auto& [parameter, value] : parameters)
        if (parameter == name) return value;
    return 0;
}

MapSet to_map_set(IrradianceMaps& maps, const FiberSettings& fiber) {
    MapSet set{std::string(name_of(fiber.model)), {}, maps.face_size, {}};
    for (const FiberNumber& number : fiber_numbers)
        if (number.model == fiber.model) set.parameters.emplace_back(number.name, number.of(fiber));
    MapLobe diffuse{"diffuse", {}, 1, {}, {maps.diffuse_statistics}};
    diffuse.cubes.push_back(std::move(maps.diffuse));
    MapLobe specular{"specular", theta_prime_degrees(maps.specular.size()), 1, {}, maps.specular_statistics};
    specular.cubes = std::move(maps.specular);
    set.lobes = {std::move(diffuse), std::move(specular)};
    return set;
}

IrradianceMaps to_irradiance_maps(MapSet set) {
    IrradianceMaps maps;
    maps.face_size = set.face_size;
    maps.exponent = set.parameter("exponent");
    for (MapLobe& lobe : set.lobes)
        if (lobe.name == "diffuse")
            maps.diffuse = std::move(lobe.cubes.at(0));
        else if (lobe.name == "specular")
            maps.specular = std::move(lobe.cubes);
    return maps;
}

}  // namespace hairbake
