#include "tests/support/source_tree.h"

#include "tests/support/run_program.h"

namespace hairbake::test_support {

std::string source_file(const std::string& name) { return shell_word(HAIRBAKE_SOURCE_DIR "/" + name); }

}  // namespace hairbake::test_support
