// What of a request has no effect, in sentences.
#pragma once

#include <string>
#include <vector>

#include "core/request/request.h"

namespace hairbake {

/// Why a bake of `request` does not look at the field of this path: its stage does not run, or the method that reads it
/// is not the one that is asked for. Empty where it looks at the field, and for an unknown path. For a field that
/// somebody has set: every request holds many fields, at their defaults, that are not looked at.
std::string why_unused(const BakeRequest& request, const std::string& path);

/// Sentences about what the request itself shows to be without effect: outputs that none of its stages writes (other
/// than the default list), voxels beside voxel_size.
std::vector<std::string> request_warnings(const BakeRequest& request);

}  // namespace hairbake
