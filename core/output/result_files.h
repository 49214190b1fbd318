// Writes the files of a result.
#pragma once

#include <filesystem>
#include <vector>

#include "core/base/progress.h"
#include "core/hair/hair_model.h"
#include "core/output/file_sink.h"
#include "core/result/bake_result.h"

namespace hairbake {

/// Checks the outputs. Call it before the bake: it takes no time.
/// Throws Error(bad_input) when one of the request's outputs cannot hold the hair.
void check_outputs(const BakeRequest& request, const HairModel& hair);

/// Writes everything but the manifest into `folder`, which is empty: the files of request.outputs for the stages that
/// ran, environment_sh.json and preview.png. Adds warnings to result.warnings.
/// Throws Error(cancelled) between files, and what FileSink and the writers throw.
std::vector<WrittenFile> write_files(BakeResult& result, const std::filesystem::path& folder, Progress& progress);

}  // namespace hairbake
