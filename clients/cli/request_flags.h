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

/// Writing a result replaces its whole folder.
/// Throws Error(usage) when the request file lies in `folder`.
void check_request_file(const RequestFlags& flags, const std::string& folder);

/// Names of the presets, the default among them.
std::vector<std::string> preset_names();

/// "Later wins: ..." and all fields for --set, for the help of a command with these flags.
std::string request_flags_help();

/// The list of all fields for --set, with unit, allowed values and default.
std::string fields_help();

/// Sets fields by "path=value". Warns on standard error of deprecated paths.
/// Throws Error(usage) naming the field.
void set_fields(BakeRequest& request, const std::vector<std::string>& settings);

/// Takes the defaults, then the preset, the request file, the flags and --set; later ones win. Warns on standard error
/// of flags without effect.
/// Throws Error(usage) naming the field.
/// Throws Error(bad_input) when the request file cannot be read.
BakeRequest make_request(const RequestFlags& flags);

}  // namespace hairbake
