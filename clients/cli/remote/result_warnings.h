// The warnings of a bake's stages, for the person who asked for the bake.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "clients/cli/remote/server.h"

namespace hairbake {

/// Those that a manifest lists: at most 100, each made fit for a terminal. The manifest is not trusted; one that is no
/// JSON object, or lists something else, has none.
std::vector<std::string> warnings_in(const std::string& manifest);

/// Those of a bake that is done. None where the server has its manifest no more.
std::vector<std::string> warnings_of_bake(Server& server, const std::string& id);

/// Prints them on standard error. `id` names the bake in each line; empty where there is only one.
void say_bake_warnings(const std::string& id, const std::vector<std::string>& warnings);

}  // namespace hairbake
