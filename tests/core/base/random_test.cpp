#include "core/base/random.h"

#include <gtest/gtest.h>

namespace hairbake {
namespace {

TEST(Random, GivesTheNumbersOfSplitMix64) {
    // The values that independent implementations of SplitMix64 publish for the seed 1234567.
    Random random(1234567);
    for (const std::uint64_t expected : {6457827717110365317u, 3203168211198807973u, 9817491932198370423u,
                                         4593380528125082431u, 16408922859458223821u})
        EXPECT_EQ(random.next_u64(), expected);
}

TEST(Random, IsUniformInTheIntervalAskedFor) {
    Random random(5);
    double mean = 0;
    const int count = 100'000;
    for (int i = 0; i < count; ++i) {
        const double value = random.next(-1, 3);
        ASSERT_GE(value, -1);
        ASSERT_LT(value, 3);
        mean += value / count;
    }
    // Mean 1, variance 4^2/12: a standard error of 1.155/sqrt(100,000) = 0.00365. Five of them.
    EXPECT_NEAR(mean, 1, 5 * 0.00365);
}

}  // namespace
}  // namespace hairbake
