// Real files that are not part of the project: looked up, never required.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace hairbake::test_support {

/// Path of `name` (e.g. "hair/sintel.hair") in $HAIRBAKE_SHARED_DATA or, without it, in ../shared/data beside the
/// repository. The file may be missing: tests then skip with missing_data().
inline std::filesystem::path shared_data(const std::string& name) {
    const char* folder = std::getenv("HAIRBAKE_SHARED_DATA");
    return (folder ? std::filesystem::path(folder) : std::filesystem::path(HAIRBAKE_SOURCE_DIR "/../shared/data")) /
           name;
}

inline std::string missing_data(const std::filesystem::path& file) {
    return file.string() + " is not there; set HAIRBAKE_SHARED_DATA to the folder of real files to run this test";
}

}  // namespace hairbake::test_support
