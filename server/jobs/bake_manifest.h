// A bake's manifest, made from its stages' manifests.
#pragma once

#include <string>

namespace hairbake {

/// What a stage's preview is called in a bake: "preview_transmittance.png".
std::string file_name_in_bake(const std::string& stage_kind, const std::string& file_name);

/// The manifest of the bake `id` as text, in the form that the command line writes: `request` is the bake's, files
/// carry their names in the bake, timings are added up and peak memory is the larger. The manifests of stages that the
/// bake does not have are empty. The same arguments give the same bytes.
std::string make_bake_manifest(const std::string& id, const std::string& request, const std::string& transmittance,
                               const std::string& irradiance);

}  // namespace hairbake
