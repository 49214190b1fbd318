#include "core/bake.h"

#include <chrono>
#include <fstream>
#include <new>
#include <numeric>
#include <utility>

#include "core/base/digest.h"
#include "core/base/naming_file.h"
#include "core/base/parallel.h"
#include "core/environment/environment_files.h"
#include "core/environment/environment_reader.h"
#include "core/hair/hair_file.h"
#include "core/hair/strand_geometry.h"
#include "core/mesh/mesh_file.h"
#include "core/output/manifest.h"
#include "core/output/result_files.h"
#include "core/output/result_folder.h"
#include "core/reference/tracer.h"
#include "core/request/request_keys.h"
#include "core/visibility/direction_set.h"
#include "core/volume/opacity_transmittance.h"

namespace hairbake {
namespace {

/// Runs `body` as the stage `name`: tells its begin and end, and adds its wall time to the result's.
template <class Body>
void run_stage(BakeResult& result, BakeProgress& progress, const std::string& name, const Body& body) {
    progress.check();
    progress.enter(name);
    const auto start = std::chrono::steady_clock::now();
    body();
    result.measured.timings_s[name] += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    progress.report(1);
}

/// The largest resident size of this process so far; 0 where the kernel does not tell.
std::uint64_t peak_memory() {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;) {
        std::uint64_t kilobytes = 0;
        if (word == "VmHWM:" && status >> kilobytes) return kilobytes * 1024;
    }
    return 0;
}

void add_warnings(BakeResult& result, const std::vector<std::string>& warnings) {
    result.warnings.insert(result.warnings.end(), warnings.begin(), warnings.end());
}

HairFacts facts_of(const StrandGeometry& strands) {
    return {strands.strand_count(),           strands.vertex_count(), strands.segment_count,
            strands.degenerate_segment_count, strands.bounds_min,     strands.bounds_max};
}

/// The answers of the stage by tracing the true strands.
Transmittance trace_all(const StrandScene& scene, const TransmittanceScene& baked,
                        const TransmittanceSettings& settings, Progress& progress) {
    std::vector<std::uint32_t> vertices(scene.strands().vertex_count());
    std::iota(vertices.begin(), vertices.end(), 0u);
    const auto directions = make_directions(settings.direction_set, settings.directions, settings.seed);
    Transmittance transmittance;
    DirectionalMeans means =
        trace_directional(scene, vertices, directions, settings.sh_bands, settings.bent_cone, progress);
    transmittance.average = std::move(means.average);
    transmittance.sh = std::move(means.sh);
    transmittance.bent_cone = std::move(means.bent_cone);
    if (baked.receiver)
        transmittance.receiver =
            trace_receiver(scene, *baked.receiver, baked.receiver_is_occluder, directions, progress);
    transmittance.directions = settings.directions;
    return transmittance;
}

/// Which of its edges make a mesh something else than a closed surface, for a warning.
std::string shell_of(const MeshTopology& topology) {
    return std::to_string(topology.open_edges) + " of its " + std::to_string(topology.edges) +
           " edges lie in one triangle only, " + std::to_string(topology.irregular_edges) +
           " in more than two or in two that disagree about the outside";
}

void read_occluder(BakeResult& result) {
    result.occluder = read_mesh(*result.request.occluder);
    result.occluder_topology = topology_of(*result.occluder);
    const MeshTopology& topology = result.occluder_topology;
    if (!topology.closed)
        result.warnings.push_back("the occluder is not closed (" + shell_of(topology) +
                                  "): it is taken as a shell that stops light from both sides");
    if (topology.inside_out)
        result.warnings.push_back("the occluder's triangles run clockwise seen from outside: they are turned round");
}

void read_hair_stage(BakeResult& result, BakeProgress& progress) {
    run_stage(result, progress, "read_hair", [&] {
        const BakeRequest& request = result.request;
        result.hair_inputs.hair = digest_of_file(*request.hair);
        if (request.occluder) result.hair_inputs.occluder = digest_of_file(*request.occluder);
        if (request.receiver) result.hair_inputs.receiver = digest_of_file(*request.receiver);
        result.transmittance_key = transmittance_key(result.hair_inputs, result.request);
        result.hair = read_hair(*request.hair);
        if (request.occluder) read_occluder(result);
        check_outputs(result);
        if (request.receiver) result.receiver = read_mesh(*request.receiver);
    });
}

/// A by the method of the request; `scene` is made where that is to trace.
Transmittance transmittance_of(const TransmittanceScene& baked, const TransmittanceSettings& settings,
                               std::optional<StrandScene>& scene, Progress& progress) {
    if (settings.method == TransmittanceMethod::trace) {
        ProgressPart building = progress.part(0, 0.1), tracing = progress.part(0.1, 1);
        scene.emplace(baked.strands, building, baked.occluder);
        return trace_all(*scene, baked, settings, tracing);
    }
    if (settings.method == TransmittanceMethod::opacity_maps)
        return bake_transmittance_opacity_maps(baked, settings, progress);
    return bake_transmittance_volume(baked, settings, progress);
}

/// Hair in memory to A in memory, and A's error bar.
void transmittance_stage(BakeResult& result, BakeProgress& progress) {
    const TransmittanceSettings& settings = result.request.transmittance;
    StrandGeometry strands;
    std::optional<StrandScene> scene;
    const TriangleMesh* occluder = result.occluder ? &*result.occluder : nullptr;
    TransmittanceScene baked{strands, occluder};
    baked.receiver = result.receiver ? &*result.receiver : nullptr;
    baked.receiver_is_occluder = baked.receiver && result.hair_inputs.receiver == result.hair_inputs.occluder;
    baked.keep_density = result.request.wants("vdb");
    run_stage(result, progress, "transmittance", [&] {
        naming_file(*result.request.hair, [&] {
            strands = make_strand_geometry(*result.hair, result.request.strand);
            result.transmittance = transmittance_of(baked, settings, scene, progress);
        });
    });
    result.hair_facts = facts_of(strands);
    add_warnings(result, result.transmittance->warnings);
    if (settings.reference_vertices == 0) return;
    run_stage(result, progress, "reference", [&] {
        ProgressPart building = progress.part(0, 0.5), tracing = progress.part(0.5, 1);
        if (!scene) scene.emplace(strands, building, occluder);
        result.error_bar =
            measure_error(*scene, result.transmittance->average, settings.reference_vertices, settings.seed, tracing);
    });
}

void read_environment_stage(BakeResult& result, BakeProgress& progress) {
    run_stage(result, progress, "read_environment", [&] {
        const std::string& file = *result.request.environment;
        result.environment_digest = digest_of_environment(file);
        result.irradiance_key = irradiance_key(result.environment_digest, result.request);
        result.environment = read_environment(file, result.request.environment_settings, progress);
    });
    add_warnings(result, result.environment->warnings);
}

void irradiance_stage(BakeResult& result, BakeProgress& progress) {
    run_stage(result, progress, "irradiance",
              [&] { result.irradiance = bake_irradiance(*result.environment, result.request.irradiance, progress); });
    result.environment->pixels = {};
    add_warnings(result, result.irradiance->warnings);
}

}  // namespace

BakeResult bake(const BakeRequest& request, int threads, BakeProgress& progress) {
    validate(request);
    BakeResult result;
    result.request = request;
    try {
        with_threads(threads, [&] {
            result.measured.threads = thread_count();
            if (request.hair) {
                read_hair_stage(result, progress);
                transmittance_stage(result, progress);
            }
            if (request.environment) {
                read_environment_stage(result, progress);
                irradiance_stage(result, progress);
            }
        });
    } catch (const std::bad_alloc&) {
        throw Error(ErrorKind::out_of_resources, "memory ran out; fewer voxels or smaller maps need less");
    }
    result.id = bake_id(result.transmittance_key, result.irradiance_key, request);
    result.measured.peak_memory_bytes = peak_memory();
    return result;
}

void write_result(BakeResult& result, const std::filesystem::path& folder, BakeProgress& progress) {
    std::optional<ResultFolder> target;
    std::vector<WrittenFile> files;
    run_stage(result, progress, "write", [&] {
        target.emplace(folder);
        files = write_files(result, target->path(), progress);
    });
    result.measured.peak_memory_bytes = peak_memory();
    // The manifest is the last file, as it names all others; its own writing is in no timing.
    write_manifest(result, files, target->path());
    progress.check();
    target->commit();
}

}  // namespace hairbake
