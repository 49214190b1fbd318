// The facade: one call that bakes, one that writes. Command line and worker see core through this header.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/output/result_folder.h"
#include "core/output/versions.h"
#include "core/request/stages.h"
#include "core/result/bake_result.h"

namespace hairbake {

struct BakeOptions {
    int threads = 0;                       ///< 0: one per core
    bool keep_environment_pixels = false;  ///< in result.inputs.environment
    bool tell_paths = false;               ///< of the inputs, in result.inputs.paths and the manifest
};

/// Finds out what can be known before a bake of `request` into `folder`: the request is valid, results may go to the
/// folder and can be written there, no input would be deleted with an earlier result, and the headers of all inputs are
/// right. Reads no file to its end. bake() and write_result() make the same checks; this call makes all of them at
/// once.
/// Throws the errors of bake() and write_result().
/// Throws Error(usage) naming an input in the folder.
void check_bake(const BakeRequest& request, const std::filesystem::path& folder);

/// The input files of the request, with the names of their fields.
std::vector<NamedInput> inputs_of(const BakeRequest& request);

/// Runs `stages` (of stages()) for `request`.
///   request: is validated first; no file but the inputs is touched
///   stages:  each names inputs that the request has
/// Throws Error: usage, bad_input naming the file, out_of_resources, cancelled.
BakeResult bake(const BakeRequest& request, std::span<const Stage* const> stages, const BakeOptions& options,
                BakeProgress& progress);

/// Runs the stages that the request asks for.
BakeResult bake(const BakeRequest& request, int threads, BakeProgress& progress);

/// Writes the request's outputs, environment_sh.json, preview.png and manifest.json to `folder`, which appears whole or
/// not at all. Completes result.measured and result.warnings.
/// Throws Error(usage) when `folder` holds other files than those of an earlier result, or an input.
/// Throws Error(bad_input) when the place cannot be written.
/// Throws Error(out_of_resources) when the disk is full.
/// Throws Error(cancelled).
void write_result(BakeResult& result, const std::filesystem::path& folder, BakeProgress& progress);

}  // namespace hairbake
