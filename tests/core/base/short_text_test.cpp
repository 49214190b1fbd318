#include "core/base/short_text.h"

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/base/json_reason.h"

namespace hairbake {
namespace {

TEST(ShortText, ControlCharactersAreShownAsEscapes) {
    EXPECT_EQ(escaped(std::string("a\0b\x1b[31m\x7f\tc\n", 12)), "a\\u0000b\\u001b[31m\\u007f\\u0009c\\u000a");
    EXPECT_EQ(escaped("a\nb\t", "\n"), "a\nb\\u0009");
    EXPECT_EQ(escaped("ü\\"), "ü\\");
}

TEST(ShortText, AnErrorIsNotCutByAZero) {
    EXPECT_STREQ(Error(ErrorKind::usage, std::string("hair a\0b\nis missing", 19)).what(),
                 "hair a\\u0000b\nis missing");
}

TEST(ShortText, NoCharacterIsCut) {
    EXPECT_EQ(shortened("aü", 2), "a...");
    EXPECT_EQ(shortened("aü", 3), "aü");
}

TEST(JsonReason, IsInPlainWords) {
    const auto reason = [](const char* text) { return json_reason(std::runtime_error(text)); };
    EXPECT_EQ(reason("[json.exception.out_of_range.406] number overflow parsing '1e999'"),
              "the number 1e999 is too large; allowed are numbers up to 1.797e308");
    EXPECT_EQ(
        reason("[json.exception.parse_error.101] parse error at line 1, column 16: syntax error while parsing value - "
               "invalid string: surrogate U+D800..U+DBFF must be followed by U+DC00..U+DFFF; last read: '\"x'"),
        "a text has one half of a pair \\uD800 to \\uDBFF, \\uDC00 to \\uDFFF; allowed are both halves in this order, "
        "or the character itself");
    EXPECT_EQ(reason("[json.exception.type_error.302] type must be string"), "type must be string");
    EXPECT_EQ(reason("out of memory"), "out of memory");
}

}  // namespace
}  // namespace hairbake
