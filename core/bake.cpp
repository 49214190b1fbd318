#include "core/bake.h"

#include <fstream>
#include <new>

#include "core/base/parallel.h"
#include "core/output/manifest.h"
#include "core/output/result_files.h"
#include "core/request/unused_fields.h"
#include "core/stages/bake_inputs.h"
#include "core/stages/stage_table.h"

namespace hairbake {
namespace {

/// The largest resident size of this process so far; 0 where the kernel does not tell.
std::uint64_t peak_memory() {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;) {
        std::uint64_t kilobytes = 0;
        if (word == "VmHWM:" && status >> kilobytes) return kilobytes * 1024;
    }
    return 0;
}

/// Every phase that a bake can have, at 0 seconds.
std::map<std::string, double> no_timings() {
    std::vector<const Stage*> all;
    for (const Stage& stage : stages()) all.push_back(&stage);
    std::map<std::string, double> timings;
    for (const Phase& phase : planned_phases(all, {})) timings[std::string(phase.name)] = 0;
    return timings;
}

std::map<std::string, InputPath> paths_of(const BakeResult& result) {
    std::map<std::string, InputPath> paths;
    for (const NamedInput& input : inputs_of(result.request))
        if (result.inputs.digests.contains(input.name))
            paths[input.name] = {input.file.string(),
                                 std::filesystem::absolute(input.file).lexically_normal().string()};
    return paths;
}

void run(std::span<const Stage* const> stages, const BakeOptions& options, BakeProgress& progress, BakeResult& result) {
    PhaseClock clock(progress, result.measured.timings_s);
    BakeInputs inputs(result.request, clock);
    StageContext context{result.request, inputs, clock};
    StageKeys keys;
    result.warnings = request_warnings(result.request);
    inputs.read_for(stages);
    for (std::string& warning : inputs.take_warnings()) result.warnings.push_back(std::move(warning));
    for (std::size_t i = 0; i < stages.size(); ++i) {
        const StagePart& part = result.parts.emplace_back(run_stage(*stages[i], context));
        keys[std::string(part.stage->name)] = part.key;
        result.warnings.insert(result.warnings.end(), part.warnings.begin(), part.warnings.end());
        inputs.release_unless_read_by(stages.subspan(i + 1));
    }
    result.id = bake_id(keys, result.request);
    result.inputs = inputs.take_facts(options.keep_environment_pixels);
    if (options.tell_paths) result.inputs.paths = paths_of(result);
    result.hair = inputs.take_hair();
}

/// Runs `body`. Errors name the folder as the caller wrote it, and not the hidden one beside it.
template <class Body>
void naming_folder(const ResultFolder& folder, const Body& body) try {
    body();
} catch (const Error& error) {
    throw Error(error.kind(), folder.as_given(error.what()), error.field(), error.system_error());
}

}  // namespace

std::vector<NamedInput> inputs_of(const BakeRequest& request) {
    std::vector<NamedInput> inputs;
    for (const auto& [name, file] : {std::pair("hair", &request.hair),
                                     {"environment", &request.environment},
                                     {"occluder", &request.occluder},
                                     {"receiver", &request.receiver}})
        if (*file) inputs.push_back({name, **file});
    return inputs;
}

void check_bake(const BakeRequest& request, const std::filesystem::path& folder) {
    validate(request);
    check_result_folder(folder);
    check_outside(folder, inputs_of(request));
    check_headers(request, stages_of(request));
    prove_writable(folder);
}

BakeResult bake(const BakeRequest& request, std::span<const Stage* const> stages, const BakeOptions& options,
                BakeProgress& progress) {
    validate(request);
    BakeResult result;
    result.request = request;
    result.measured.timings_s = no_timings();
    try {
        with_threads(options.threads, [&] {
            result.measured.threads = thread_count();
            run(stages, options, progress, result);
        });
    } catch (const std::bad_alloc&) {
        throw Error(ErrorKind::out_of_resources, "memory ran out; fewer voxels or smaller maps need less");
    }
    result.measured.peak_memory_bytes = peak_memory();
    return result;
}

BakeResult bake(const BakeRequest& request, int threads, BakeProgress& progress) {
    return bake(request, stages_of(request), {threads}, progress);
}

void write_result(BakeResult& result, const std::filesystem::path& folder, BakeProgress& progress) {
    std::optional<ResultFolder> target;
    std::vector<WrittenFile> files;
    PhaseClock(progress, result.measured.timings_s).run("write", [&](Progress& writing) {
        check_outside(folder, inputs_of(result.request));
        target.emplace(folder);
        naming_folder(*target, [&] { files = write_files(result, target->path(), writing); });
    });
    result.measured.peak_memory_bytes = peak_memory();
    // The manifest is the last file, as it names all others; its own writing is in no timing.
    naming_folder(*target, [&] { write_manifest(result, files, target->path()); });
    progress.check();
    target->commit();
}

}  // namespace hairbake
