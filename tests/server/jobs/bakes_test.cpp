#include "server/jobs/bakes.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "server/jobs/queue.h"
#include "server/store/blob_store.h"
#include "server/store/database.h"
#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

using Json = nlohmann::json;

/// Bakes without workers.
class BakesTest : public ::testing::Test {
protected:
    /// A bake of a model, asked for by names: JSON as in BakePlan.
    static BakePlan bake(const std::string& id, const std::string& model, const std::string& names = "{}") {
        BakePlan plan;
        plan.id = id;
        plan.request = "{}";
        plan.names = names;
        plan.hair = model;
        plan.stages = {{"first", "stage of " + id, "core", "{}", {}}};
        return plan;
    }

    void submit_batch(const std::vector<BakePlan>& plans, const std::string& id) {
        queue.submit_batch(id, "{}", [&](Sql&, const std::function<void(const BakePlan&)>& take) {
            for (const BakePlan& plan : plans) take(plan);
        });
    }

    /// Reads a list page by page, one bake a page.
    std::vector<std::string> ids(BakeFilter filter) {
        std::vector<std::string> found;
        filter.limit = 1;
        for (;;) {
            const Json page = Json::parse(bakes.list(filter));
            for (const Json& one : page["bakes"]) found.push_back(one["id"]);
            if (page["next"].is_null()) return found;
            filter.cursor = std::stoll(page["next"].get<std::string>());
        }
    }

    using Ids = std::vector<std::string>;
    test_support::TemporaryFolder folder;
    Database database{folder / "test.db"};
    BlobStore store{folder / "store", database};
    Queue queue{database, store, {1, 0}};
    Bakes bakes{database, queue};
};

TEST_F(BakesTest, ABatchListsItsBakesOnceAndNewestFirst) {
    queue.submit({bake("a", "one"), bake("b", "two"), bake("c", "one")});
    submit_batch({bake("b", "two"), bake("d", "one"), bake("b", "two"), bake("a", "one")}, "batch");
    submit_batch({bake("e", "one")}, "other");
    EXPECT_EQ(ids({.batch = "batch"}), (Ids{"d", "b", "a"}));
    EXPECT_EQ(ids({.model = "one", .batch = "batch"}), (Ids{"d", "a"}));
    queue.cancel("d");
    EXPECT_EQ(ids({.state = JobState::queued, .batch = "batch"}), (Ids{"b", "a"}));
    EXPECT_EQ(ids({.batch = "none"}), Ids{});
}

TEST_F(BakesTest, ANameListsABakeOnceThatItWasAskedByForTwoFieldsOrTwice) {
    const std::string both = R"({"hair": {"path": "x", "version": 1}, "environment": {"path": "x", "version": 2}})";
    const std::string first = R"({"hair": {"path": "x", "version": 1}})";
    const std::string other = R"({"hair": {"path": "y", "version": 1}})";
    submit_batch({bake("a", "one", both), bake("b", "two", other), bake("c", "one", first)}, "batch");
    queue.submit({bake("b", "two", first), bake("a", "one", first)});
    EXPECT_EQ(ids({.name = "x"}), (Ids{"c", "b", "a"}));
    EXPECT_EQ(ids({.name = "y"}), (Ids{"b"}));
    EXPECT_EQ(ids({.model = "one", .name = "x"}), (Ids{"c", "a"}));
    EXPECT_EQ(ids({.name = "y", .batch = "batch"}), (Ids{"b"}));
    const Json page = Json::parse(bakes.list({.name = "x"}));
    EXPECT_EQ(page["bakes"][2]["names"]["environment"], (Json{{"path", "x"}, {"version", 2}}));
}

}  // namespace
}  // namespace hairbake
