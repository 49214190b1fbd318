// Progress as a bar on a terminal, as JSON lines, or not at all.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/progress.h"
#include "core/request/stages.h"

namespace hairbake {

/// `mode`: "auto" is a bar on standard error when that is a terminal (plain lines on one without escape codes, such as
/// TERM=dumb), else nothing; "json" is one JSON object a line on
/// standard output, and one that cannot be written is an error of report(); "none" is silent. Updates at most ten times
/// a second, from any thread. It begins in the first of `phases`.
std::unique_ptr<BakeProgress> make_progress_display(const std::string& mode, const std::vector<Phase>& phases);

/// `text` as a JSON string with its quotes. Bytes that are not UTF-8 stay as they are.
std::string json_string(std::string_view text);

}  // namespace hairbake
