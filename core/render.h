// The facade of pictures: from a result folder, or from hair and environment, to PNG and EXR.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/progress.h"
#include "core/render/camera.h"
#include "core/render/renderer.h"
#include "core/request/request.h"

namespace hairbake {

/// How the light on a strand is found; fiber_lighting.h says what each does. Each leaves one approximation out.
enum class ShadingMode {
    baked,        ///< A(x) (Kd D(t) + Ks S(t, theta')) from the maps, as the run time does it
    brute,        ///< A(x) times the sum over every light of the environment: no maps
    reference,    ///< the sum over every light with the traced transmittance inside: no decoupling
    directional,  ///< the sum over every light with the baked directional transmittance inside
};

/// What `directional` uses: automatic takes the harmonics where the bake has them, else the bent cones.
enum class Directional { automatic, sh, bent_cone };

/// Hair and surface. The defaults are a light brown whose strands send on six tenths of the light diffusely.
struct RenderLook {
    double albedo = 0.6;                           ///< Kd = albedo * color / pi^2, 0 to 1
    std::array<double, 3> color{0.78, 0.52, 0.3};  ///< linear RGB, 0 to 1 each
    double specular = 0.06;                        ///< Ks, white, 0 to 10
    std::array<double, 3> mesh_albedo{0.5, 0.36, 0.28};
};

struct RenderRequest {
    std::optional<std::string> result;  ///< result folder; without it the bake runs in memory
    /// Without result: what to bake; hair and environment are given (the channels transmittance and tangent of the mode
    /// baked need no environment, nor a result's maps). With result: `hair`, `environment` and `occluder`
    /// say where the files are that it was baked from (else: its transmittance.hair, and the paths in its manifest);
    /// nothing else is looked at.
    BakeRequest bake;
    std::optional<std::string> mesh;         ///< OBJ file shown with the hair
    std::optional<std::string> camera_file;  ///< JSON (camera_json.h), instead of `orbit`
    OrbitSettings orbit;                     ///< frames the hair and the mesh
    RenderLook look;
    ShadingMode mode = ShadingMode::baked;
    Directional directional = Directional::automatic;
    bool transmittance = true;  ///< false: A = 1 (baked and brute)
    bool background = true;     ///< false: black
    int light_samples = 16;     ///< of each kernel at every hit of `reference`, 1 to 65536
    FrameSettings frame{640, 640, 16, 1, Channel::beauty};
};

struct RenderedPicture {
    int width = 0, height = 0;
    Channel channel = Channel::beauty;
    std::vector<Vec3f> pixels;                                  ///< linear, rows from the top
    std::vector<std::pair<std::string, std::string>> metadata;  ///< for the EXR file; neither dates nor paths
    double render_seconds = 0;                                  ///< of the stage render alone
    std::vector<std::string> warnings;
};

/// Validates, reads, bakes where needed and renders on `threads` threads (0: one per core). Stages reported: those of
/// bake() and "render". Throws Error: usage naming the field, bad_input naming the file (also when a given file is not
/// the one that the result was baked from), out_of_resources, cancelled.
RenderedPicture render(const RenderRequest& request, int threads, BakeProgress& progress);

/// Stops that bring the brighter tenth of what is not black to a bright but unclipped tone (output/tone.h); 0 for
/// channels that are no light.
double automatic_exposure(const RenderedPicture& picture);

/// Writes the picture by the name's ending: .exr linear float32, .png through the film curve at `stops`
/// (transmittance: 0 to 1 as 0 to 255; tangent: -1 to 1). The file appears whole. Throws Error(usage) for another
/// ending, and what FileSink throws.
void write_picture(const RenderedPicture& picture, double stops, const std::filesystem::path& file);

}  // namespace hairbake
