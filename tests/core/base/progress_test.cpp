#include "core/base/progress.h"

#include <gtest/gtest.h>

namespace hairbake {
namespace {

TEST(Progress, ChecksPassUntilACancel) {
    Progress progress;
    progress.report("transmittance", 0.5);
    EXPECT_NO_THROW(progress.check());
    EXPECT_FALSE(progress.cancelled());
    progress.cancel();
    EXPECT_TRUE(progress.cancelled());
    try {
        progress.check();
        ADD_FAILURE() << "the check passed";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::cancelled);
    }
}

}  // namespace
}  // namespace hairbake
