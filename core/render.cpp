#include "core/render.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <memory>
#include <new>
#include <numbers>
#include <optional>

#include "core/bake.h"
#include "core/base/error.h"
#include "core/base/luminance.h"
#include "core/base/naming_file.h"
#include "core/base/parallel.h"
#include "core/environment/light_set.h"
#include "core/fiber/fiber_model.h"
#include "core/hair/strand_geometry.h"
#include "core/hair/tangents.h"
#include "core/irradiance/added_lights.h"
#include "core/irradiance/irradiance_maps.h"
#include "core/mesh/mesh_file.h"
#include "core/output/file_sink.h"
#include "core/output/manifest.h"
#include "core/output/picture_encoding.h"
#include "core/output/tone.h"
#include "core/render/camera_json.h"
#include "core/render/fiber_lighting.h"
#include "core/render/renderer.h"
#include "core/render_input.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

Vec3d vector_of(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

/// The lights, where the mode or the mesh needs them. Refers to the model.
std::optional<LightSum> make_lights(const RenderInput& input, const FiberModel& model, const Progress& progress) {
    if (!input.environment) return {};
    LightSet lights = make_light_set(*input.environment, light_resolution(model.sharpness()), progress);
    return LightSum(with_directional_lights(std::move(lights), input.bake.irradiance.lights), model);
}

/// Whether the mode directional takes the harmonics; else it takes the bent cones. `has_sh`, `has_cones`: of the bake.
/// Throws Error(usage) where the bake has not what the request asks for.
bool takes_sh(const RenderRequest& request, bool has_sh, bool has_cones) {
    if (has_sh && request.directional != Directional::bent_cone) return true;
    if (has_cones && request.directional != Directional::sh) return false;
    throw Error(ErrorKind::usage,
                "the bake has no such directional transmittance; bake with transmittance.sh_bands (1 to 4) or "
                "transmittance.bent_cone",
                "mode");
}

DirectionalTransmittance directional_of(const RenderRequest& request, const RenderInput& input) {
    const bool sh = takes_sh(request, !input.sh.empty(), !input.bent_cone.empty());
    DirectionalTransmittance transmittance;
    transmittance.average = input.average;
    if (sh) {
        transmittance.sh = input.sh;
        transmittance.sh_bands = input.bake.transmittance.sh_bands;
    } else {
        transmittance.bent_cone = input.bent_cone;
    }
    return transmittance;
}

Camera camera_of(const RenderRequest& request, const StrandGeometry& strands, const std::optional<TriangleMesh>& mesh) {
    Vec3f low = strands.bounds_min, high = strands.bounds_max;
    if (mesh)
        for (const Vec3f& p : mesh->positions)
            for (int axis = 0; axis < 3; ++axis) {
                low[axis] = std::min(low[axis], p[axis]);
                high[axis] = std::max(high[axis], p[axis]);
            }
    const double aspect = double(request.frame.width) / request.frame.height;
    if (request.camera_file) return read_camera(*request.camera_file, low, high, aspect);
    return orbit_camera(request.orbit, low, high, aspect);
}

template <class Value>
std::string text(const Value& value) {
    char buffer[64];
    std::snprintf(buffer, sizeof buffer, "%.9g", double(value));
    return buffer;
}

std::string text(const Vec3d& v) { return text(v.x) + " " + text(v.y) + " " + text(v.z); }

std::vector<std::pair<std::string, std::string>> describe(const RenderRequest& request, const FiberSettings& fiber,
                                                          const Camera& camera, const Vec3d& kd) {
    std::vector<std::pair<std::string, std::string>> facts{
        {"hairbake:mode", std::string(name_of(request.mode))},
        {"hairbake:channel", std::string(name_of(request.frame.channel))},
        {"hairbake:samples", text(request.frame.samples)},
        {"hairbake:lightSamples", text(request.light_samples)},
        {"hairbake:seed", std::to_string(request.frame.seed)},
        {"hairbake:kd", text(kd)},
        {"hairbake:ks", text(request.look.specular)}};
    for (const FiberNumber& number : fiber_numbers)
        if (number.model == fiber.model)
            facts.emplace_back("hairbake:" + std::string(number.name), text(number.of(fiber)));
    facts.insert(facts.end(), {{"hairbake:eye", text(camera.eye)},
                               {"hairbake:backward", text(camera.backward)},
                               {"hairbake:up", text(camera.up)},
                               {"hairbake:tangentOfHalfField", text(camera.tangent)}});
    return facts;
}

/// The lighting of the mode, with all that it refers to.
struct ModeLighting {
    VertexTransmittance average;
    DirectionalTransmittance directional;
    EffectiveTransmittance effective;
    std::unique_ptr<FiberLighting> lighting;

    ModeLighting(const RenderRequest& request, const RenderInput& input, const StrandScene& scene,
                 const std::optional<LightSum>& lights, Progress& progress) {
        if (request.transmittance) average.average = input.average;
        switch (request.mode) {
            case ShadingMode::baked:
                lighting = shows_light(request) ? baked_lighting(average, *input.maps) : average_lighting(average);
                break;
            case ShadingMode::brute:
                lighting = brute_lighting(average, *lights);
                break;
            case ShadingMode::reference:
                lighting = reference_lighting(VertexRays(scene, progress), average, *lights, request.light_samples);
                break;
            case ShadingMode::directional:
                directional = directional_of(request, input);
                lighting = directional_lighting(directional, *lights);
                break;
            case ShadingMode::effective: {
                const EffectiveSettings& settings = input.bake.effective_transmittance;
                effective = {input.effective, static_cast<std::size_t>(settings.diffuse_components()),
                             static_cast<std::size_t>(settings.cosines)};
                lighting = effective_lighting(effective, *input.maps);
                break;
            }
        }
    }
    ModeLighting(const ModeLighting&) = delete;
    ModeLighting& operator=(const ModeLighting&) = delete;
};

RenderedPicture render_input(const RenderRequest& request, const RenderInput& input, BakeProgress& progress) {
    const std::unique_ptr<const FiberModel> model = make_fiber_model(input.bake.fiber);
    const StrandGeometry strands =
        naming_file(*input.bake.hair, [&] { return make_strand_geometry(input.hair, input.bake.strand); });
    const std::vector<Vec3f> tangents = vertex_tangents(input.hair);
    progress.enter("reference");
    const StrandScene scene(strands, progress, input.occluder ? &*input.occluder : nullptr);
    const FirstHits hits(scene, input.mesh ? &*input.mesh : nullptr);
    const std::optional<LightSum> lights = make_lights(input, *model, progress);
    const Camera camera = camera_of(request, strands, input.mesh);
    const Vec3d kd = vector_of(request.look.color) * (request.look.albedo / (std::numbers::pi * std::numbers::pi));
    const ModeLighting mode(request, input, scene, lights, progress);
    const RenderScene shown{.hits = hits,
                            .tangents = tangents,
                            .strands = strands,
                            .lighting = *mode.lighting,
                            .lobes = model->lobes(),
                            .kd = kd,
                            .ks = Vec3d(request.look.specular),
                            .mesh_lights = lights ? &*lights : nullptr,
                            .mesh_albedo = vector_of(request.look.mesh_albedo),
                            .background = request.background && input.environment ? &*input.environment : nullptr};

    RenderedPicture picture{.width = request.frame.width,
                            .height = request.frame.height,
                            .channel = request.frame.channel,
                            .pixels = {},
                            .metadata = describe(request, input.bake.fiber, camera, kd),
                            .warnings = input.warnings};
    const auto start = std::chrono::steady_clock::now();
    progress.enter("render");
    picture.pixels = render_frame(shown, camera, request.frame, progress);
    picture.render_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return picture;
}

std::vector<std::uint8_t> screen_bytes(const RenderedPicture& picture, double stops) {
    std::vector<std::uint8_t> bytes;
    bytes.reserve(picture.pixels.size() * 3);
    const auto byte = [](double share) {
        return static_cast<std::uint8_t>(std::lround(255 * std::clamp(share, 0.0, 1.0)));
    };
    for (const Vec3f& pixel : picture.pixels) {
        Color color = tone(pixel, stops);
        if (picture.channel == Channel::transmittance) color = {byte(pixel.x), byte(pixel.y), byte(pixel.z)};
        if (picture.channel == Channel::tangent)
            color = {byte(0.5 + 0.5 * double(pixel.x)), byte(0.5 + 0.5 * double(pixel.y)),
                     byte(0.5 + 0.5 * double(pixel.z))};
        bytes.insert(bytes.end(), color.begin(), color.end());
    }
    return bytes;
}

/// ".exr" or ".png".
std::string ending_of(const fs::path& file) {
    std::string ending = file.extension().string();
    for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (ending == ".exr" || ending == ".png") return ending;
    throw Error(ErrorKind::usage, "out is " + file.string() + "; allowed is a name that ends in .exr or .png", "out");
}

/// The files that a person names for a picture, with the names of their fields.
std::vector<NamedInput> scene_files(const RenderRequest& request) {
    std::vector<NamedInput> files = inputs_of(request.bake);
    if (request.mesh) files.push_back({"mesh", *request.mesh});
    if (request.camera_file) files.push_back({"camera", *request.camera_file});
    return files;
}

/// What can be known before anything is read to its end.
void check_scene(const RenderRequest& request) {
    validate(request);
    const Vec3f low, high(1);  // of any hair: only the camera's own numbers are checked
    if (request.camera_file)
        read_camera(*request.camera_file, low, high, 1);
    else
        orbit_camera(request.orbit, low, high, 1);
    if (request.mesh) check_mesh(*request.mesh);
    check_render_input(request);
    if (request.mode == ShadingMode::directional && !request.result)
        takes_sh(request, request.bake.transmittance.sh_bands > 0, request.bake.transmittance.bent_cone);
}

}  // namespace

void check_render(const RenderRequest& request, const std::vector<fs::path>& files) {
    for (const fs::path& file : files) ending_of(file);
    check_scene(request);
    std::vector<NamedInput> kept = scene_files(request);
    if (request.result)
        for (const std::string& name : files_of_result(*request.result))
            kept.push_back({"result's file " + name, fs::path(*request.result) / name});
    for (const NamedInput& input : kept)
        for (const fs::path& file : files)
            if (std::error_code error; fs::equivalent(input.file, file, error))
                throw Error(
                    ErrorKind::usage,
                    "out is " + file.string() + ", which is the " + input.name + ": the picture would replace it",
                    "out");
    for (const fs::path& file : files) prove_file_writable(file);
}

RenderedPicture render(const RenderRequest& request, int threads, BakeProgress& progress) {
    check_scene(request);
    RenderedPicture picture;
    try {
        with_threads(threads, [&] {
            const RenderInput input = read_render_input(request, progress);
            picture = render_input(request, input, progress);
        });
    } catch (const std::bad_alloc&) {
        throw Error(ErrorKind::out_of_resources, "memory ran out");
    }
    return picture;
}

double automatic_exposure(const RenderedPicture& picture) {
    if (!is_light(picture.channel)) return 0;
    std::vector<float> luminances;
    for (const Vec3f& pixel : picture.pixels)
        if (const float value = luminance(pixel); value > 0) luminances.push_back(value);
    return exposure_for(std::move(luminances));
}

void write_picture(const RenderedPicture& picture, double stops, const std::filesystem::path& file) {
    write_whole_file(file, ending_of(file) == ".exr"
                               ? encode_exr(picture.pixels, picture.width, picture.height, picture.metadata)
                               : encode_png(screen_bytes(picture, stops), picture.width, picture.height, {}));
}

}  // namespace hairbake
