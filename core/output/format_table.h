// The output formats, each with the function that writes it. A new format is a file with such a function, a row here,
// and its name in config/request.schema.json (the list of outputs, and x-stages: the stages that write it).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/progress.h"
#include "core/output/file_sink.h"
#include "core/result/bake_result.h"

namespace hairbake {

/// The input of a writer. Refers to its parts.
struct OutputContext {
    const BakeResult& result;
    const std::filesystem::path& folder;  ///< where the files go
    Progress& progress;
    std::vector<std::string>& warnings;  ///< the writer adds its own
};

/// Writes the files of one format of one stage's part; none where the part holds nothing for it.
/// Throws Error(cancelled) between files, and what FileSink throws.
using Writer = std::vector<WrittenFile>(const OutputContext&, const StagePart&);

Writer write_npy, write_hair_colors, write_exr, write_glb_lines, write_ktx2, write_dds, write_raw, write_vdb,
    write_environment_harmonics;

struct FormatWriter {
    std::string_view format;  ///< of output_formats(); empty: always written
    Writer* write;
};

/// In the order in which the manifest lists the files of a part.
constexpr FormatWriter format_writers[] = {
    {"npy", write_npy},       {"hair", write_hair_colors}, {"exr", write_exr},
    {"glb", write_glb_lines}, {"ktx2", write_ktx2},        {"dds", write_dds},
    {"raw", write_raw},       {"vdb", write_vdb},          {"", write_environment_harmonics},
};

}  // namespace hairbake
