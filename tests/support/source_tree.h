// Files of the project that tests run, such as scripts.
#pragma once

#include <string>

namespace hairbake::test_support {

/// Absolute path of `name`, given from the root of the project, as one word for /bin/sh.
std::string source_file(const std::string& name);

}  // namespace hairbake::test_support
