#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>
#include <thread>

#include "server/store/database.h"
#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

/// Keeps a state of the database open, so that no checkpoint can begin the log anew.
class OpenState {
public:
    explicit OpenState(Database& database) {
        thread_ = std::thread([this, &database] {
            database.read([this](Sql& sql) {
                sql.rows("SELECT count(*) FROM pages");
                std::unique_lock lock(mutex_);
                is_open_ = true;
                changed_.notify_all();
                changed_.wait(lock, [this] { return may_end_; });
            });
        });
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return is_open_; });
    }
    ~OpenState() {
        {
            const std::lock_guard lock(mutex_);
            may_end_ = true;
        }
        changed_.notify_all();
        thread_.join();
    }

private:
    std::mutex mutex_;
    std::condition_variable changed_;
    bool is_open_ = false, may_end_ = false;
    std::thread thread_;
};

// Whoever makes a checkpoint and then writes holds locks of its own, as StoreIdentity::advance() does. Its write must not
// call the action for a long log, which would take them again.
TEST(DatabaseLog, AWriteAfterACheckpointDoesNotAskForAnotherOne) {
    const test_support::TemporaryFolder folder;
    Database database{folder / "test.db"};
    const auto write_pages = [&](std::int64_t count) {
        database.write([&](Sql& sql) { sql.run("INSERT INTO pages VALUES(zeroblob(?))", {count * 4096}); });
    };
    database.write([](Sql& sql) { sql.run("CREATE TABLE pages(x)"); });
    int acts = 0;
    database.when_log_is_long([&] {
        ++acts;
        database.checkpoint();
    });
    const OpenState state(database);
    write_pages(1010);  // over 1000
    EXPECT_EQ(acts, 1);
    write_pages(900);  // below 1000 more
    EXPECT_EQ(acts, 1);
    const auto held = database.lock();
    database.checkpoint();
    write_pages(150);  // more than 1000 since the action, not since the checkpoint
    EXPECT_EQ(acts, 1);
}

// Relative: without a checkpoint in between, the action comes again.
TEST(DatabaseLog, ALogThatGrowsOnAsksAgain) {
    const test_support::TemporaryFolder folder;
    Database database{folder / "test.db"};
    database.write([](Sql& sql) { sql.run("CREATE TABLE pages(x)"); });
    int acts = 0;
    database.when_log_is_long([&] {
        ++acts;
        database.checkpoint();
    });
    const OpenState state(database);
    for (int i = 0; i < 3; ++i)
        database.write([](Sql& sql) { sql.run("INSERT INTO pages VALUES(zeroblob(?))", {std::int64_t{1100} * 4096}); });
    EXPECT_EQ(acts, 3);
}

}  // namespace
}  // namespace hairbake
