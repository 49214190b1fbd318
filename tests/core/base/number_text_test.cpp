#include "core/base/number_text.h"

#include <gtest/gtest.h>

#include "core/base/short_number.h"

namespace hairbake {
namespace {

TEST(NumberText, TakesTheNotationsThatPeopleUse) {
    EXPECT_EQ(number_of(".05"), 0.05);
    EXPECT_EQ(number_of("1."), 1.0);
    EXPECT_EQ(number_of("+5"), 5.0);
    // Relatives.
    EXPECT_EQ(number_of("-.5e1"), -5.0);
    EXPECT_EQ(number_of("+.5"), 0.5);
    EXPECT_EQ(number_of("010"), 10.0);  // not octal
    EXPECT_EQ(number_of("1e3"), 1000.0);
    EXPECT_EQ(number_of("-0"), 0.0);
}

TEST(NumberText, TakesNothingElse) {
    for (const char* text : {"", "+", "-", ".", "e5", "1e", "1.2.3", "+-5", "--5", "1,5", "0x10", "inf", "nan", "-inf",
                             "NaN", " 5", "5 ", "5px", "1e999"})
        EXPECT_FALSE(number_of(text)) << text;
}

TEST(ShortNumber, WritesWholeNumbersInFull) {
    EXPECT_EQ(short_number(0), "0");
    EXPECT_EQ(short_number(-0.0), "0");
    EXPECT_EQ(short_number(65536), "65536");
    EXPECT_EQ(short_number(9007199254740991), "9007199254740991");
    EXPECT_EQ(short_number(1e18), "1e+18");
    EXPECT_EQ(short_number(0.25), "0.25");
    EXPECT_EQ(short_number(-1e-6), "-1e-06");
}

}  // namespace
}  // namespace hairbake
