// The flags that make a bake request, shared by every command that bakes.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/request/request.h"

namespace CLI {
class App;
}

namespace hairbake {

/// The parts of a request that the command line gives.
struct RequestFlags {
    std::optional<std::string> hair, environment, occluder, receiver, request_file, preset;
    std::map<std::string, std::string> fields;  ///< flag to value
    std::vector<std::string> settings;          ///< path=value
};

/// Adds the flags of all fields but the hair; `flags` must live as long as `command` parses. `environment_help` is the
/// help of --env.
void add_request_flags(CLI::App& command, RequestFlags& flags, const std::string& environment_help);

/// "Later wins: ..." for the help of a command with these flags.
std::string request_flags_help();

/// Takes the defaults, then the preset, the request file, the flags and --set; later ones win. Warns on standard error
/// of flags without effect.
/// Throws Error(usage) naming the field.
/// Throws Error(bad_input) when the request file cannot be read.
BakeRequest make_request(const RequestFlags& flags);

}  // namespace hairbake
