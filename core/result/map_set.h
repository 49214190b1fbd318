// Named irradiance maps of a result: for each lobe of the fibre model a list of cube maps.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/environment/cube_map.h"
#include "core/fiber/fiber_settings.h"
#include "core/irradiance/irradiance_maps.h"

namespace hairbake {

/// One lobe's maps. A lobe that depends on the eye has a map for each theta' (a slice); another has one map.
struct MapLobe {
    std::string name;                       ///< of the lobe and its files: "diffuse", "specular"
    std::vector<double> theta_prime_deg;    ///< of the slices, from the tangent; empty for a lobe that has one map
    int orders = 1;                         ///< maps a slice, for fibre models that expand over an azimuth
    std::vector<CubeTexels> cubes;          ///< [slice * orders + order]
    std::vector<MapStatistics> statistics;  ///< of each cube, or empty

    bool has_slices() const { return !theta_prime_deg.empty(); }
    /// Name of a cube's file, without its ending: "diffuse", "specular_07". The number has as many digits as the last
    /// one needs, two at least.
    std::string file_name(std::size_t cube) const;
    /// For people and metadata: "diffuse", "specular 7".
    std::string label(std::size_t cube) const;
};

/// All maps of a stage. Values are radiance times steradian; the factors of the lobes (Kd, Ks) are not applied.
struct MapSet {
    std::string model;                                       ///< fibre model that the maps are for
    std::vector<std::pair<std::string, double>> parameters;  ///< of the model: {"exponent", 64}
    int face_size = 0;                                       ///< texels on a cube's edge
    std::vector<MapLobe> lobes;

    /// 0 where the model has no parameter of this name.
    double parameter(std::string_view name) const;
    /// Null where there is no lobe of this name.
    const MapLobe* find(std::string_view name) const;
    std::size_t cube_count() const;
};

/// The diffuse and specular maps of the chosen model, moved out of `maps`.
MapSet to_map_set(IrradianceMaps& maps, const FiberSettings& fiber);

/// The other way, for looking maps up: texels, face size and the exponent of Kajiya-Kay, without statistics.
IrradianceMaps to_irradiance_maps(MapSet set);

}  // namespace hairbake
