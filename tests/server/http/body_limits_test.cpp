// Places, budget and shape of bodies.
#include <gtest/gtest.h>

#include <future>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>
#include <vector>

#include "core/base/short_text.h"
#include "server/http/body_budget.h"
#include "server/http/body_pace.h"
#include "server/http/body_places.h"
#include "server/http/body_shape.h"
#include "server/http/utf8.h"
#include "server/store/refusal.h"

namespace hairbake {
namespace {

using Json = nlohmann::json;

TEST(BodyPlaces, CountInAllAndForEachAddress) {
    BodyPlaces places(4, 2);
    std::vector<std::optional<BodyPlaces::Place>> held;
    for (const char* address : {"192.0.2.1", "192.0.2.1", "192.0.2.2"}) {
        auto place = places.take(address);
        ASSERT_TRUE(place) << address;
        held.push_back(std::move(place));
    }
    EXPECT_FALSE(places.take("192.0.2.1"));
    held.push_back(places.take(""));  // not forwarded: no address
    EXPECT_FALSE(places.take("192.0.2.3"));
    EXPECT_EQ(places.refusal("192.0.2.1"),
              "2 uploads and long bodies are under way from your address; allowed are up to 2 at once ([listen] "
              "bodies_per_address)");
    EXPECT_EQ(places.refusal("192.0.2.3"),
              "4 uploads and long bodies are under way; allowed are up to 4 at once ([listen] bodies)");
    held[0].reset();
    EXPECT_FALSE(places.take("192.0.2.1"));  // it has one, and one is free
    EXPECT_EQ(places.refusal("192.0.2.1"),
              "1 uploads and long bodies are under way from your address, and 1 of 4 places are free; an address may "
              "take one more only while more are free than it has ([listen] bodies)");
    EXPECT_TRUE(places.take("192.0.2.3"));
    held[1].reset();
    EXPECT_TRUE(places.take("192.0.2.1"));
    EXPECT_TRUE(places.take("192.0.2.1"));  // the first of these is free again
}

TEST(BodyPlaces, KeepSomeForAddressesThatHaveNone) {
    BodyPlaces places(48, 16);
    std::vector<BodyPlaces::Place> held;
    std::vector<int> counts;
    for (int address = 1; address <= 8; ++address) {
        const std::string text = "192.0.2." + std::to_string(address);
        counts.push_back(0);
        while (auto place = places.take(text)) {
            held.push_back(std::move(*place));
            ++counts.back();
        }
    }
    // An address with k places stops when no more than k are free.
    EXPECT_EQ(counts, (std::vector<int>{16, 16, 8, 4, 2, 1, 1, 0}));
}

TEST(BodyPace, CountsWhatCameInEachWindowOfWaiting) {
    using namespace std::chrono_literals;
    BodyPace pace({1000, 10s});
    EXPECT_TRUE(pace.add(1, 9s));
    EXPECT_TRUE(pace.add(9999, 1s));  // 10,000 bytes in 10 s
    EXPECT_TRUE(pace.add(1'000'000, 0s));
    EXPECT_TRUE(pace.add(0, 10s));  // what came before the wait is of this window, too
    EXPECT_FALSE(pace.add(9999, 10s));
    BodyPace any({0, 10s});
    EXPECT_TRUE(any.add(0, 1000s));
}

TEST(BodyPlaces, OfAnIpv6AddressCountTheFirst64Bits) {
    BodyPlaces places(4, 1);
    const auto held = places.take("2001:db8:0:1::1");
    EXPECT_TRUE(held);
    EXPECT_FALSE(places.take("2001:db8:0:1:ffff::2"));
    EXPECT_TRUE(places.take("2001:db8:0:2::1"));
}

TEST(BodyBudget, GivesSharesInTheirOrder) {
    BodyBudget budget(10);
    std::optional<BodyBudget::Share> first(budget.take(6));
    std::vector<int> order;
    std::mutex mutex;
    std::promise<void> waits;
    std::thread large([&] {
        waits.set_value();
        const auto share = budget.take(100);  // the whole budget
        const std::lock_guard lock(mutex);
        order.push_back(1);
    });
    waits.get_future().wait();
    EXPECT_TRUE(order.empty());
    first.reset();
    large.join();
    const auto again = budget.take(10);  // everything is back
    EXPECT_EQ(order, std::vector<int>{1});
}

class BodyShape : public ::testing::Test {
protected:
    /// The field of the refusal, or "" when the text passes; "-" for a text that is malformed.
    static std::string refused(const std::string& text) {
        try {
            check_shape(text, schema);
            return "";
        } catch (const Refusal& refusal) {
            return refusal.why() == Refused::malformed ? "-" : refusal.field();
        }
    }
    static inline const Json schema = Json::parse(R"({
        "type": "object", "additionalProperties": false, "properties": {
            "list": {"type": "array", "maxItems": 2, "items": {"type": "array", "items": {"type": "integer"}}},
            "text": {"type": ["string", "null"], "maxLength": 3},
            "choice": {"enum": ["a", 1]},
            "either": {"anyOf": [{"const": "x"}, {"type": "array", "maxItems": 1}]}}})");
};

TEST_F(BodyShape, TakesWhatTheSchemaNames) {
    for (const char* text : {"{}", R"({"list": [[1], [2]], "text": "abc", "choice": "b"})", R"({"text": null})",
                             R"({"either": "x"})", R"({"either": [1]})"})
        EXPECT_EQ(refused(text), "") << text;
    EXPECT_EQ(refused(R"({"text": "äöü"})"), "");  // characters, not bytes
}

TEST_F(BodyShape, EndsAtTheFirstErrorAndNamesItsPlace) {
    for (const auto& [text, field] : {std::pair(R"({"list": [[1], [2], [3]]})", "list"),
                                      {R"({"list": [[1], [2, "x"]], "text": 1})", "list[1][1]"},
                                      {R"({"list": [{}]})", "list[0]"},
                                      {R"({"text": [1]})", "text"},
                                      {R"({"text": "0123456789abc"})", "text"},
                                      {R"({"choice": []})", "choice"},
                                      {R"({"text": null, "text": null})", "text"},
                                      {R"({"either": [1, 2]})", "either"},
                                      {R"({"either": {}})", "either"},
                                      {R"({"other": 1})", "other"},
                                      {R"({"list": [)", "-"},
                                      {"", "-"},
                                      {"{} {}", "-"}})
        EXPECT_EQ(refused(text), field) << text;
    EXPECT_EQ(refused(R"({"list": [[)" + std::string(400, '1') + "]]}"), "-");  // beyond every number
    EXPECT_EQ(refused(R"({"list": [[1,)" + std::string(500, ' ') + R"(1]]})"), "");
    std::string many = "0";
    for (int i = 0; i < 64; ++i) many += ",0";
    EXPECT_EQ(refused(R"({"list": [[)" + many + "]]}"), "list[0]");  // without maxItems: 64
}

/// Fault: the refusal named no field. Relatives: a name of a field, an item of a list, the body itself, nesting, and
/// bytes that are no UTF-8.
TEST_F(BodyShape, NamesThePlaceOfWhatItDoesNotParse) {
    const std::string large(40'000, '1');
    for (const auto& [text, words] :
         {std::pair("{\"text\": \"" + large + "\"}",
                    "text is a text or number of more than 32768 bytes; allowed are up to 3"),
          {"{\"list\": [[1], [2, " + large, "list[1][1] is a text or number of more"},
          {"{\"text\": null, \"" + large, "the body has a field whose name is a text or number"},
          {"\"" + large, "the body is a text or number of more"},
          {"{\"list\": [[[", "list[0][0] is [...]; allowed is"},
          {std::string("{\"list\": ") + std::string(100'000, '['), "list[0][0] is [...]; allowed is"},
          {std::string(100'000, '['), "the body is [...]; allowed is"},
          {"{\"text\": \"a\xc3\"}", "text is no UTF-8: the byte 0xc3 at byte 11 of the body"},
          {"{\"text\": \"\xe2\x82", "text is no UTF-8: the byte 0xe2 at byte 10"},
          {"{\"text\": \"\xed\xa0\x80\"}", "text is no UTF-8: the byte 0xed"},
          {"{\"text\": null, \"\xff\": 1}", "the body has a field whose name is no UTF-8: the byte 0xff"},
          {"{\"\": 1}", "\"\" is not a field; allowed are choice, either, list, text"},
          {"{\"other\": \"" + large, "other is not a field"}})  // an earlier error
        try {
            check_shape(text, schema);
            FAIL() << text.substr(0, 80);
        } catch (const Refusal& refusal) {
            EXPECT_NE(std::string(refusal.what()).find(words), std::string::npos) << refusal.what();
        }
    EXPECT_EQ(refused("{\"text\": \"\xf0\x9f\x98\x80\"}"), "");
}

TEST(Utf8, FindsTheFirstByteOfWhatIsNoCharacter) {
    // By the Unicode standard, table 3-7: the first and the last character of each row, and their neighbours.
    for (const std::string text : {"\x7f", "\xc2\x80", "\xdf\xbf", "\xe0\xa0\x80", "\xed\x9f\xbf", "\xee\x80\x80",
                                   "\xef\xbf\xbf", "\xf0\x90\x80\x80", "\xf4\x8f\xbf\xbf"})
        EXPECT_FALSE(first_not_utf8("ab" + text)) << text;
    for (const std::string text :
         {"\x80", "\xc1\xbf", "\xc2", "\xc2\x7f", "\xc2\xc0", "\xe0\x9f\xbf", "\xed\xa0\x80", "\xe1\x80",
          "\xe1\x80\x7f", "\xf0\x8f\xbf\xbf", "\xf4\x90\x80\x80", "\xf5\x80\x80\x80", "\xf1\x80\x80", "\xff"})
        EXPECT_EQ(first_not_utf8("ab" + text + "\""), 2u) << text;
}

TEST(ShortText, CutsNoCharacter) {
    EXPECT_EQ(shortened("aö", 2), "a...");
    EXPECT_EQ(shortened("aö", 3), "aö");
    EXPECT_EQ(shortened("aöb", 3), "aö...");
    EXPECT_EQ(shortened("\xf0\x9f\x98\x80", 3), "...");
}

}  // namespace
}  // namespace hairbake
