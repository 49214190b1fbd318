// JSON <-> BakeRequest: the only code that knows the request's JSON form.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/request/request.h"

namespace hairbake {

/// The whole request as JSON text: every field, in the order of the documentation. `indent` < 0 gives one line.
std::string to_json(const BakeRequest& request, int indent = 2);

/// Takes over the fields that the JSON object `text` names and leaves the others as they are.
///   source: stands for the text in messages
/// Returns a warning for each field that `text` names by its deprecated place of the first version
/// ("irradiance.rotation_deg" for environment_settings.rotation_deg).
/// Throws Error(usage) naming the field, what was found and what is allowed, for broken JSON, JSON of more than 64
/// levels, an unknown field, a field given at both of its places, or a wrong type; then nothing is changed. validate()
/// checks the ranges.
std::vector<std::string> merge_json(BakeRequest& request, std::string_view text, const std::string& source);

/// Sets one field by its path: set_field(request, "transmittance.method", "trace").
///   value: JSON or, where it is not, plain text; a list may be given with commas ("npy,exr", "0,90,0")
/// Returns and throws as merge_json.
std::vector<std::string> set_field(BakeRequest& request, const std::string& path, const std::string& value);

/// Where the first version had the field of this path; empty where the place is the same, or there is no such field.
std::string first_place_of(const std::string& path);

/// Paths of all fields, "irradiance.sh_bands.diffuse" and the like, in the order of to_json.
std::vector<std::string> field_paths();

}  // namespace hairbake
