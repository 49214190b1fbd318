// Real files that are not part of the project: looked up, never required.
#pragma once

#include <filesystem>
#include <string>

namespace hairbake::test_support {

/// Path of `name` (e.g. "hair/sintel.hair") in $HAIRBAKE_SHARED_DATA or, without it, in ../shared/data beside the
/// repository. The file may be missing: tests then skip with missing_data().
std::filesystem::path shared_data(const std::string& name);

std::string missing_data(const std::filesystem::path& file);

}  // namespace hairbake::test_support
