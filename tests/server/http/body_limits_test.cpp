// Places, budget and shape of bodies.
#include <gtest/gtest.h>

#include <future>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>
#include <vector>

#include "server/http/body_budget.h"
#include "server/http/body_places.h"
#include "server/http/body_shape.h"
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
    held[0].reset();
    EXPECT_TRUE(places.take("192.0.2.1"));
    EXPECT_TRUE(places.take("192.0.2.1"));  // the first of these is free again
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
    EXPECT_EQ(refused(R"({"text": ")" + std::string(40'000, 'x') + "\"}"), "-");
}

}  // namespace
}  // namespace hairbake
