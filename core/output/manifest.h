// manifest.json: the inputs, the settings and the figures of a bake, and the files of its result.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/output/file_sink.h"
#include "core/result/bake_result.h"

namespace hairbake {

/// The manifest as JSON text. `timings_s`, `peak_memory_bytes` and the block `measured` differ between runs of the same
/// request; everything else is the same bit for bit.
std::string make_manifest(const BakeResult& result, const std::vector<WrittenFile>& files);

/// Writes it to `folder`/manifest.json.
void write_manifest(const BakeResult& result, const std::vector<WrittenFile>& files,
                    const std::filesystem::path& folder);

/// The text of a manifest.json. It is not trusted: any file may have this name.
/// Throws Error(bad_input) naming the file where it cannot be read, is longer than 16 MiB (one of 257 maps has 0.3) or
/// is nested deeper than 64 levels.
std::string read_manifest_text(const std::filesystem::path& file);

/// Names of the files that the manifest.json in `folder` lists.
/// Throws Error(bad_input) when the folder has no manifest.json of hairbake.
std::vector<std::string> files_of_result(const std::filesystem::path& folder);

}  // namespace hairbake
