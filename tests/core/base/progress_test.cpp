#include "core/base/progress.h"

#include <gtest/gtest.h>

namespace hairbake {
namespace {

TEST(Progress, ChecksPassUntilACancel) {
    Progress progress;
    progress.report(0.5);
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

TEST(Progress, APartReportsItsShareOfTheWhole) {
    struct Last : Progress {
        double fraction = -1;
        void report(double f) override { fraction = f; }
    } whole;
    ProgressPart half = whole.part(0.5, 1), quarter = half.part(0.5, 1);  // the last quarter of the whole
    half.report(0);
    EXPECT_EQ(whole.fraction, 0.5);
    quarter.report(0);
    EXPECT_EQ(whole.fraction, 0.75);
    quarter.report(1);
    EXPECT_EQ(whole.fraction, 1);
}

TEST(Progress, ACancelOfTheWholeReachesThePartOfAPart) {
    Progress whole;
    ProgressPart half = whole.part(0, 0.5), quarter = half.part(0, 0.5);
    EXPECT_NO_THROW(quarter.check());
    whole.cancel();
    EXPECT_TRUE(quarter.cancelled());
    EXPECT_THROW(quarter.check(), Error);
}

}  // namespace
}  // namespace hairbake
