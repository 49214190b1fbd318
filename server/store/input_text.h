// How people know an input.
#pragma once

#include <optional>
#include <string>

namespace hairbake {

class Sql;

/// "the model hero/hair@3 (sha256:...)" of a blob that a client sent, with the newest of its names; "the environment
/// sha256:..." of one without a name; "the file sha256:..." of one that is listed nowhere. Nothing when no client sent
/// it.
std::optional<std::string> input_text(Sql& sql, const std::string& digest);

}  // namespace hairbake
