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

/// What the command line says of a request.
struct RequestFlags {
    std::optional<std::string> hair, environment, occluder, receiver, request_file, preset;
    std::map<std::string, std::string> fields;  ///< flag to value
    std::vector<std::string> settings;          ///< path=value
};

/// Adds the flags of everything but the hair; `flags` must live as long as `command` parses. `environment_help` says
/// what --env may be there.
void add_request_flags(CLI::App& command, RequestFlags& flags, const std::string& environment_help);

/// "Later wins: ..." for the help of a command with these flags.
std::string request_flags_help();

/// Defaults, then the preset, the request file, the flags and --set: what comes later wins. Throws Error(usage) naming
/// the field, Error(bad_input) when the request file cannot be read. Warns on standard error of flags without effect.
BakeRequest make_request(const RequestFlags& flags);

}  // namespace hairbake
