#include "core/render_input.h"

#include <utility>

#include "core/bake.h"
#include "core/base/digest.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/environment/environment_files.h"
#include "core/environment/environment_reader.h"
#include "core/hair/hair_file.h"
#include "core/mesh/mesh_file.h"
#include "core/output/manifest.h"
#include "core/result_reader.h"
#include "core/stages/bake_inputs.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

/// Returns `file` when its digest is that of the file that was baked.
std::string checked(const std::string& file, const std::string& digest, const std::string& what) {
    const std::string found = what == "environment" ? digest_of_environment(file) : digest_of_file(file);
    if (found != digest)
        throw Error(ErrorKind::bad_input,
                    file + " is not the " + what + " that the result was baked from (its SHA-256 differs)", what);
    return file;
}

/// Whether the input is there: a file, a folder, or the six files of a pattern.
bool is_there(const std::string& path) {
    if (path.find("{face}") == std::string::npos) return fs::exists(path);
    try {
        find_environment_files(path);
        return true;
    } catch (const Error&) {
        return false;
    }
}

/// The path of an input that the command does not name: as the bake named it, or where it was then.
/// Throws Error(usage) naming every path that was sought.
std::string stored_path(const StoredResult& stored, const std::string& name,
                        const std::optional<std::string>& in_request, const std::string& need) {
    std::vector<std::string> sought;
    if (in_request) sought.push_back(*in_request);
    if (const auto was = stored.absolute_paths.find(name); was != stored.absolute_paths.end())
        if (!in_request || was->second != *in_request) sought.push_back(was->second);
    for (const std::string& path : sought)
        if (is_there(path)) return path;
    const std::string flag = name == "environment" ? "--env" : "--" + name;
    std::string text = need + ": give the file (" + flag + ")";
    for (std::size_t i = 0; i < sought.size(); ++i) text += (i == 0 ? "; sought was " : " and ") + sought[i];
    if (in_request && !sought.empty() && fs::path(*in_request).is_relative())
        text += " (from " + fs::current_path().string() + ")";
    throw Error(ErrorKind::usage, text, name);
}

/// The hair file of a result: the given one, or its own copy, or the one that it was baked from.
std::string hair_of(const RenderRequest& request, const StoredResult& stored) {
    if (request.bake.hair) {
        const std::string digest = digest_of_file(*request.bake.hair);
        if (digest == stored.hair_file_digest) return *request.bake.hair;
        return checked(*request.bake.hair, stored.digests.at("hair"), "hair");
    }
    if (!stored.hair_file_digest.empty())
        return checked((fs::path(*request.result) / "transmittance.hair").string(), stored.hair_file_digest, "hair");
    return checked(stored_path(stored, "hair", stored.request.hair, *request.result + " does not hold its hair model"),
                   stored.digests.at("hair"), "hair");
}

std::string environment_of(const RenderRequest& request, const StoredResult& stored) {
    const std::string file =
        request.bake.environment
            ? *request.bake.environment
            : stored_path(stored, "environment", stored.request.environment,
                          "the environment that " + *request.result +
                              " was baked from is needed for the background, a mesh's light and every mode but baked");
    // Any environment may light a result of hair alone.
    return !stored.digests.contains("environment") ? file
                                                   : checked(file, stored.digests.at("environment"), "environment");
}

std::string occluder_of(const RenderRequest& request, const StoredResult& stored) {
    const std::string file =
        request.bake.occluder
            ? *request.bake.occluder
            : stored_path(stored, "occluder", stored.request.occluder,
                          "the mode reference needs the occluder that " + *request.result + " was baked with");
    return checked(file, stored.digests.at("occluder"), "occluder");
}

void read_sky(RenderInput& input, BakeProgress& progress) {
    progress.enter("read_environment");
    input.environment = read_environment(*input.bake.environment, input.bake.environment_settings, progress);
}

/// Takes the arrays that the pictures need, as far as they are there.
void take_arrays(std::vector<VertexArray>& arrays, RenderInput& input) {
    const std::pair<const ArrayKind*, std::vector<float>*> wanted[] = {
        {&average_transmittance_kind(), &input.average},
        {&transmittance_sh_kind(), &input.sh},
        {&bent_cone_kind(), &input.bent_cone},
        {&effective_transmittance_kind(), &input.effective}};
    for (const auto& [kind, values] : wanted)
        if (find_array(arrays, *kind)) *values = take_values(arrays, *kind);
}

RenderInput from_folder(const RenderRequest& request) {
    StoredResult stored = read_result(*request.result);
    if (!stored.digests.contains("hair"))
        throw Error(ErrorKind::usage, *request.result + " is a bake without hair: there is nothing to show", "result");
    RenderInput input;
    input.bake = stored.request;
    input.bake.hair = hair_of(request, stored);
    if (needs_environment(request)) input.bake.environment = environment_of(request, stored);
    if (stored.digests.contains("occluder") && request.mode == ShadingMode::reference)
        input.occluder = read_mesh(occluder_of(request, stored));
    input.hair = read_hair(*input.bake.hair, {input.bake.strand.time});
    take_arrays(stored.arrays, input);
    const bool needs_average = request.mode == ShadingMode::directional || request.transmittance;
    if (needs_average && input.average.size() != input.hair.vertex_count())
        throw Error(ErrorKind::bad_input, *request.result + " has the transmittance of " +
                                              std::to_string(input.average.size()) + " vertices, the hair has " +
                                              std::to_string(input.hair.vertex_count()) +
                                              "; bake with npy among the outputs");
    if (request.mode == ShadingMode::effective && input.effective.empty())
        throw Error(ErrorKind::usage,
                    *request.result +
                        " holds no effective transmittance; bake with effective_transmittance.enabled "
                        "and npy among the outputs",
                    "mode");
    if (uses_maps(request.mode) && shows_light(request) && !stored.maps)
        throw Error(ErrorKind::usage,
                    *request.result + " holds no maps; bake with an environment and npy among the outputs", "result");
    if (stored.maps) input.maps = to_irradiance_maps(std::move(*stored.maps));
    return input;
}

/// The bake in memory that the mode needs. The irradiance maps are baked for the modes that use them.
/// Throws Error(usage) where an input is not named.
BakeRequest bake_for(const RenderRequest& request) {
    if (!request.bake.hair) throw Error(ErrorKind::usage, "give a result folder, or --hair and --env", "hair");
    if (!request.bake.environment && (shows_light(request) || needs_environment(request)))
        throw Error(ErrorKind::usage, "give a result folder, or --hair and --env", "environment");
    BakeRequest wanted = request.bake;
    wanted.transmittance.reference_vertices = 0;
    wanted.effective_transmittance.enabled = request.mode == ShadingMode::effective;
    if (!uses_maps(request.mode) || !shows_light(request)) wanted.environment.reset();
    return wanted;
}

RenderInput from_bake(const RenderRequest& request, BakeProgress& progress) {
    RenderInput input;
    input.bake = request.bake;
    const BakeRequest wanted = bake_for(request);
    // Before the bake, which may take long: the environment may be broken.
    if (needs_environment(request) && !wanted.environment) read_sky(input, progress);
    BakeResult result =
        bake(wanted, stages_of(wanted), {thread_count(), wanted.environment && needs_environment(request)}, progress);
    input.hair = std::move(*result.hair);
    if (request.bake.occluder) input.occluder = read_mesh(*request.bake.occluder);
    for (StagePart& part : result.parts) {
        take_arrays(part.arrays, input);
        if (part.maps) input.maps = to_irradiance_maps(std::move(*part.maps));
    }
    if (wanted.environment && needs_environment(request)) input.environment = std::move(result.inputs.environment);
    input.warnings = std::move(result.warnings);
    return input;
}

}  // namespace

void check_render_input(const RenderRequest& request) {
    const BakeRequest& named = request.bake;
    if (request.result) files_of_result(*request.result);
    if (!request.result) {
        const BakeRequest wanted = bake_for(request);
        validate(wanted);
        check_headers(wanted, stages_of(wanted));
    }
    if (request.result && named.hair) check_groom(*named.hair);
    if (request.result && named.occluder) check_mesh(*named.occluder);
    if (named.environment && needs_environment(request))
        check_environment(*named.environment, named.environment_settings);
}

RenderInput read_render_input(const RenderRequest& request, BakeProgress& progress) {
    std::optional<MeshFile> mesh;
    if (request.mesh) mesh = read_mesh_file(*request.mesh);
    RenderInput input = request.result ? from_folder(request) : from_bake(request, progress);
    if (needs_environment(request) && !input.environment) read_sky(input, progress);
    if (mesh) {
        for (const std::string& warning : mesh->warnings) input.warnings.push_back("the mesh: " + warning);
        input.mesh = std::move(mesh->mesh);
    }
    progress.check();
    return input;
}

}  // namespace hairbake
