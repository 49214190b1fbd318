#include "core/base/json_nesting.h"

#include <gtest/gtest.h>

namespace hairbake {
namespace {

TEST(JsonNesting, CountsListsAndObjectsThatLieInOneAnother) {
    // Three levels: the outer list, the object, the list in it; the second object closes before it matters.
    const std::string three = R"([{"a": [1, 2]}, {}, []])";
    EXPECT_TRUE(nested_deeper_than(three, 2));
    EXPECT_FALSE(nested_deeper_than(three, 3));
    EXPECT_FALSE(nested_deeper_than("", 0));
    EXPECT_FALSE(nested_deeper_than("12", 0));
}

TEST(JsonNesting, BracketsInStringsDoNotCount) {
    EXPECT_FALSE(nested_deeper_than(R"(["[[{{", "\"[[", "\\"])", 1));
    EXPECT_TRUE(nested_deeper_than(R"(["\\", [1]])", 1));  // the string ends after the escaped backslash
}

TEST(JsonNesting, AllowsSixtyFourLevelsAndSaysSo) {
    const auto lists = [](int levels) { return std::string(levels, '[') + std::string(levels, ']'); };
    EXPECT_NO_THROW(check_nesting(lists(64), "a.json", ErrorKind::usage));
    try {
        check_nesting(lists(65), "a.json", ErrorKind::usage, "outputs");
        ADD_FAILURE() << "was accepted";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::usage);
        EXPECT_EQ(error.field(), "outputs");
        EXPECT_STREQ(error.what(), "a.json is nested deeper than 64 levels");
    }
}

}  // namespace
}  // namespace hairbake
