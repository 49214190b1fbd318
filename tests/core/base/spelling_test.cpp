#include "core/base/spelling.h"

#include <gtest/gtest.h>

namespace hairbake {
namespace {

const std::vector<std::string> options{"--hair", "--voxels", "--threads", "--out"};

TEST(Spelling, FindsTheWordThatDiffersLeast) {
    EXPECT_EQ(closest_word("--voxel", options), "--voxels");    // a letter is left out
    EXPECT_EQ(closest_word("--voxxels", options), "--voxels");  // inserted
    EXPECT_EQ(closest_word("--vixels", options), "--voxels");   // replaced
    EXPECT_EQ(closest_word("--voxles", options), "--voxels");   // two are swapped
    EXPECT_EQ(closest_word("-out", options), "--out");
    EXPECT_EQ(did_you_mean("--haire", options), " (did you mean --hair?)");
}

TEST(Spelling, FindsNothingThatIsFar) {
    EXPECT_EQ(closest_word("--wait", options), "");  // two of four letters differ from hair
    EXPECT_EQ(closest_word("--out-of-this-world", options), "");
    EXPECT_EQ(closest_word("", options), "");
    EXPECT_EQ(closest_word(std::string(100'000, 'x'), options), "");
    EXPECT_EQ(did_you_mean("--wait", options), "");
}

}  // namespace
}  // namespace hairbake
