// The request's `fiber` block: the fibre model and its parameters.
//
// A model is listed here seven times: its kind, its parameters, the declaration of its make_fiber_model(), its member
// of FiberSettings, its alternative of FiberParameters, its line in fiber_models, and a line in fiber_numbers for each
// parameter. Request fields, ranges, stage keys and metadata of pictures and maps are made from these tables.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <variant>

#include "core/base/names.h"

namespace hairbake {

class FiberModel;

enum class FiberModelKind {
    kajiya_kay  ///< diffuse and specular lobe, both zonal about the tangent (core/fiber/kajiya_kay.h)
};

struct KajiyaKayParameters {
    double exponent = 64;  ///< p of the specular lobe, 0 to 4096
};
std::unique_ptr<const FiberModel> make_fiber_model(const KajiyaKayParameters& parameters);

/// The request's `fiber` block. Only the chosen model's parameters are read.
struct FiberSettings {
    FiberModelKind model = FiberModelKind::kajiya_kay;
    KajiyaKayParameters kajiya_kay;
};

/// The parameters of one model.
using FiberParameters = std::variant<KajiyaKayParameters>;

/// One line for each model.
struct FiberModelEntry {
    FiberModelKind kind;
    std::string_view name;   ///< value of the JSON field fiber.model
    std::string_view block;  ///< JSON block of its parameters inside fiber
    bool has_maps;           ///< whether it has zonal_kernels(): else requests of irradiance maps are refused at once
    FiberParameters (*parameters)(const FiberSettings&);
};
inline constexpr std::array fiber_models{
    FiberModelEntry{FiberModelKind::kajiya_kay, "kajiya-kay", "kajiya_kay", true,
                    [](const FiberSettings& settings) { return FiberParameters(settings.kajiya_kay); }},
};

/// One line for each number that a model takes; its JSON field is fiber.<block>.<name>.
struct FiberNumber {
    FiberModelKind model;
    std::string_view name;
    double low, high;  ///< both allowed
    double& (*member)(FiberSettings&);

    double of(FiberSettings settings) const { return member(settings); }
};
inline constexpr std::array fiber_numbers{
    FiberNumber{FiberModelKind::kajiya_kay, "exponent", 0, 4096,
                [](FiberSettings& settings) -> double& { return settings.kajiya_kay.exponent; }},
};

/// The chosen model's line.
constexpr const FiberModelEntry& entry_of(FiberModelKind kind) {
    for (const FiberModelEntry& entry : fiber_models)
        if (entry.kind == kind) return entry;
    HAIRBAKE_ASSERT(!"fiber_models lacks a model");
    return fiber_models.front();
}
constexpr std::string_view name_of(FiberModelKind kind) { return entry_of(kind).name; }

/// "fiber.kajiya_kay.exponent".
inline std::string path_of(const FiberNumber& number) {
    return "fiber." + std::string(entry_of(number.model).block) + "." + std::string(number.name);
}

}  // namespace hairbake
