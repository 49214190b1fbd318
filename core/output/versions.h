// The versions that a manifest names.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace hairbake {

/// hairbake's own version, "0.1.0".
std::string version();

/// Name and version of the libraries whose numbers enter a result, in alphabetical order.
std::vector<std::pair<std::string, std::string>> library_versions();

}  // namespace hairbake
