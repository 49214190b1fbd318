// A request for a picture: what is shown, how it is lit, and from where it is seen.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "core/base/names.h"
#include "core/render/camera.h"
#include "core/render/frame_settings.h"
#include "core/request/request.h"

namespace hairbake {

/// The way to find the light on a strand (fiber_lighting.h).
enum class ShadingMode {
    baked,        ///< A(x) (Kd D(t) + Ks S(t, theta')) from the maps, as at run time
    brute,        ///< A(x) times the sum over every light of the environment: no maps
    reference,    ///< the sum over every light with the traced transmittance inside: no decoupling
    directional,  ///< the sum over every light with the baked directional transmittance inside
    effective,    ///< Kd Ad(x) D(t) + Ks As(x, theta') S(t, theta') from the maps, as at run time
};
inline constexpr std::array shading_mode_names{
    EnumName{ShadingMode::baked, "baked"},         EnumName{ShadingMode::brute, "brute"},
    EnumName{ShadingMode::reference, "reference"}, EnumName{ShadingMode::directional, "directional"},
    EnumName{ShadingMode::effective, "effective"},
};
constexpr std::string_view name_of(ShadingMode mode) { return name_in(shading_mode_names, mode); }

/// The transmittance of the mode directional. `automatic` takes the harmonics where the bake has them, else the bent
/// cones.
enum class Directional { automatic, sh, bent_cone };
inline constexpr std::array directional_names{
    EnumName{Directional::automatic, "auto"},
    EnumName{Directional::sh, "sh"},
    EnumName{Directional::bent_cone, "bent-cone"},
};

/// Hair and surface. The defaults are a light brown whose strands scatter six tenths of the light diffusely.
struct RenderLook {
    double albedo = 0.6;                           ///< Kd = albedo * color / pi^2, 0 to 1
    std::array<double, 3> color{0.78, 0.52, 0.3};  ///< linear RGB, 0 to 1 each
    double specular = 0.06;                        ///< Ks, white, 0 to 10
    std::array<double, 3> mesh_albedo{0.5, 0.36, 0.28};
};

struct RenderRequest {
    std::optional<std::string> result;  ///< result folder; without it the bake runs in memory
    /// Without result: the bake. Hair and environment are given; the channels transmittance and tangent of the mode
    /// baked need no environment. With result: only `hair`, `environment` and `occluder` are used. They are the places
    /// of the files that the result was baked from (default: its transmittance.hair, and the paths in its manifest).
    BakeRequest bake;
    std::optional<std::string> mesh;         ///< OBJ file shown with the hair
    std::optional<std::string> camera_file;  ///< JSON (camera_json.h), instead of `orbit`
    OrbitSettings orbit;                     ///< frames the hair and the mesh
    RenderLook look;
    ShadingMode mode = ShadingMode::baked;
    Directional directional = Directional::automatic;
    bool transmittance = true;  ///< false: A = 1 (baked and brute)
    bool background = true;     ///< false: black
    int light_samples = 16;     ///< drawn for each lobe at every hit in mode reference, 1 to 65536
    FrameSettings frame{640, 640, 16, 1, Channel::beauty};
};

/// Throws Error(usage) naming the first field of the picture that is out of range; `bake` is not looked at.
void validate(const RenderRequest& request);

/// Whether the mode looks the light up in irradiance maps.
constexpr bool uses_maps(ShadingMode mode) { return mode == ShadingMode::baked || mode == ShadingMode::effective; }

/// Whether the picture needs light on the hair: the mode baked shows transmittance and tangents without any.
bool shows_light(const RenderRequest& request);

/// Whether the picture needs the environment's pixels: for the lights, the background or the mesh.
bool needs_environment(const RenderRequest& request);

}  // namespace hairbake
