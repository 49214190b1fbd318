#include "tests/support/shared_data.h"

#include <cstdlib>

namespace hairbake::test_support {

std::filesystem::path shared_data(const std::string& name) {
    const char* folder = std::getenv("HAIRBAKE_SHARED_DATA");
    return (folder ? std::filesystem::path(folder) : std::filesystem::path(HAIRBAKE_SOURCE_DIR "/../shared/data")) /
           name;
}

std::string missing_data(const std::filesystem::path& file) {
    return file.string() + " is not there; set HAIRBAKE_SHARED_DATA to the folder of real files to run this test";
}

}  // namespace hairbake::test_support
