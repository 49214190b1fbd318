// The manifest of a bake, merged from those of its stages.
#pragma once

#include <string>
#include <vector>

namespace hairbake {

/// The name of a stage's file in a bake. Every stage writes preview.png; in a bake it is preview_STAGE.png.
std::string file_name_in_bake(const std::string& stage_kind, const std::string& file_name);

struct StageManifest {
    std::string kind;  ///< the stage's name in the stage table
    std::string json;  ///< as the worker wrote it
};

/// The manifest in the form that the command line writes. The same arguments give the same bytes.
///
/// `id` and `request` (JSON) are the bake's.
/// `parts` are its stages, in the order of the stage table. Files get their names in the bake, timings are added up,
/// and the peak memory is the largest, since the stages ran in processes of their own.
std::string make_bake_manifest(const std::string& id, const std::string& request,
                               const std::vector<StageManifest>& parts);

}  // namespace hairbake
