// The facade: one call that bakes, one that writes. Command line and worker see core through this header.
#pragma once

#include <filesystem>
#include <span>

#include "core/base/progress.h"
#include "core/output/result_folder.h"
#include "core/output/versions.h"
#include "core/request/stages.h"
#include "core/result/bake_result.h"

namespace hairbake {

struct BakeOptions {
    int threads = 0;                       ///< 0: one per core
    bool keep_environment_pixels = false;  ///< in result.inputs.environment
};

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
/// Throws Error(usage) when `folder` holds other files than those of an earlier result.
/// Throws Error(bad_input) when the place cannot be written.
/// Throws Error(out_of_resources) when the disk is full.
/// Throws Error(cancelled).
void write_result(BakeResult& result, const std::filesystem::path& folder, BakeProgress& progress);

}  // namespace hairbake
