// Messages of the command line, on standard error.
#pragma once

#include <string>
#include <vector>

namespace hairbake {

/// "hairbake: info: ...", "hairbake: warning: ..." and "hairbake: error: ...", the level in colour on a terminal.
/// Thread-safe.
void say_note(const std::string& text);
void say_warning(const std::string& text);
void say_warnings(const std::vector<std::string>& texts);
void say_error(const std::string& text);

}  // namespace hairbake
