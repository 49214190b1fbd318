// The facade: one call that bakes, one that writes. Command line and worker see core through this header.
#pragma once

#include <filesystem>

#include "core/bake_result.h"
#include "core/base/progress.h"
#include "core/output/result_folder.h"
#include "core/output/versions.h"

namespace hairbake {

/// Runs the stages that `request` asks for on `threads` threads (0: one per core). Validates first; touches no file
/// but the inputs. Throws Error: usage, bad_input naming the file, out_of_resources, cancelled.
BakeResult bake(const BakeRequest& request, int threads, BakeProgress& progress);

/// Writes the request's outputs, environment_sh.json, preview.png and manifest.json to `folder`, which appears whole or
/// not at all. Completes result.measured and result.warnings. Throws Error(usage) when `folder` holds other files
/// than an earlier result's, Error(bad_input) when the place cannot be written, Error(out_of_resources) when the
/// disk is full, Error(cancelled).
void write_result(BakeResult& result, const std::filesystem::path& folder, BakeProgress& progress);

}  // namespace hairbake
