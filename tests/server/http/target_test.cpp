#include "server/http/target.h"

#include <gtest/gtest.h>

namespace hairbake {
namespace {

TEST(Target, IsTakenApartAndDecoded) {
    const auto target = read_target("/v1/names/environment/a%20b?limit=5&cursor=%2Fx&flag");
    ASSERT_TRUE(target);
    EXPECT_EQ(target->path, (std::vector<std::string>{"v1", "names", "environment", "a b"}));
    EXPECT_EQ(target->query, (std::map<std::string, std::string>{{"limit", "5"}, {"cursor", "/x"}, {"flag", ""}}));
    EXPECT_TRUE(read_target("/")->path.empty());
    EXPECT_EQ(read_target("/%41")->path[0], "A");  // an escape that ends the text
}

TEST(Target, TricksAreRefused) {
    for (const char* text : {"", "x", "http://host/", "//", "/a//b", "/..", "/a/./b", "/%2e%2e/b", "/a%2fb", "/a%00",
                             "/a%0d%0a", "/%", "/%4", "/%zz", "/a#b", "/a?x=%0a"})
        EXPECT_FALSE(read_target(text)) << text;
}

TEST(Length, HasDigitsAlone) {
    EXPECT_EQ(read_length("0"), 0u);
    EXPECT_EQ(read_length("18446744073709551615"), UINT64_MAX);
    for (const char* text : {"", "+1", "-1", " 1", "1 ", "0x1", "1e3", "18446744073709551616"})
        EXPECT_FALSE(read_length(text)) << text;
}

}  // namespace
}  // namespace hairbake
