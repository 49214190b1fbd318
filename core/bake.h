// The facade: one call that bakes, one that writes. Command line and worker see core through this header.
#pragma once

#include <filesystem>
#include <string>

#include "core/bake_result.h"
#include "core/base/progress.h"

namespace hairbake {

/// Runs the stages that `request` asks for on `threads` threads (0: one per core). Validates first; touches no file
/// but the inputs. Throws Error: usage, bad_input naming the file, out_of_resources, cancelled.
BakeResult bake(const BakeRequest& request, int threads, Progress& progress);

/// Writes the request's outputs, environment_sh.json, preview.png and manifest.json to `folder`, which appears whole or
/// not at all. Completes result.measured and result.warnings. Throws Error(usage) when `folder` holds other files
/// than an earlier result's, Error(bad_input) when the place cannot be written, Error(out_of_resources) when the
/// disk is full, Error(cancelled).
void write_result(BakeResult& result, const std::filesystem::path& folder, Progress& progress);

/// The check of `folder` that write_result makes, to be had before a long bake.
void check_result_folder(const std::filesystem::path& folder);

/// Removes what write_result of this process has written so far for `folder`, for a process that is about to end; may
/// be called from another thread.
void discard_staging(const std::filesystem::path& folder) noexcept;

/// hairbake's own version, "0.1.0".
std::string version();

}  // namespace hairbake
