#include "server/jobs/worker_words.h"

#include <gtest/gtest.h>

#include <fstream>
#include <utility>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

class WorkerWordsTest : public ::testing::Test {
protected:
    void write(const std::string& text) { std::ofstream(file, std::ios::app) << text << std::flush; }

    test_support::TemporaryFolder folder;
    const std::filesystem::path file = folder / "words.jsonl";
    std::vector<std::pair<std::string, double>> progress;
    WorkerWords words{file,
                      [this](std::string_view phase, double fraction) { progress.emplace_back(phase, fraction); }};
};

TEST_F(WorkerWordsTest, ReadsLinesAsTheyAreWritten) {
    EXPECT_FALSE(words.read_more());  // there is no file yet
    write(R"({"phase": "one", "fraction": 0.25})");
    words.read_more();
    EXPECT_TRUE(progress.empty());  // the line is not complete
    EXPECT_FALSE(words.has_begun());
    write("\n{\"phase\": \"two\", \"fraction\": 0.5}\n{\"done\": {\"strands\"");
    words.read_more();
    EXPECT_EQ(progress, (std::vector<std::pair<std::string, double>>{{"one", 0.25}, {"two", 0.5}}));
    EXPECT_FALSE(words.last_word());
    write(": 3}}\n");
    words.read_more();
    ASSERT_TRUE(words.last_word());
    EXPECT_FALSE(words.last_word()->error);
    EXPECT_EQ(words.last_word()->facts, R"({"strands":3})");
}

TEST_F(WorkerWordsTest, ReadsAnError) {
    write(R"({"error": {"kind": "bad_input", "message": "broken", "field": "hair"}})"
          "\n");
    words.read_more();
    ASSERT_TRUE(words.last_word());
    EXPECT_EQ(words.last_word()->error, ErrorKind::bad_input);
    EXPECT_EQ(words.last_word()->message, "broken");
    EXPECT_EQ(words.last_word()->field, "hair");
    EXPECT_FALSE(words.last_word()->is_trouble);
    write(R"({"error": {"kind": "bad_input", "message": "the disk is full", "machine": true}})"
          "\n");
    words.read_more();
    EXPECT_TRUE(words.last_word()->is_trouble);
}

TEST_F(WorkerWordsTest, TellsWhetherTheWorkerReachedItsTask) {
    EXPECT_FALSE(words.read_more());
    EXPECT_EQ(words.trouble(), ENOENT);
    write("{\"other\": 1}\n");
    words.read_more();
    EXPECT_EQ(words.trouble(), 0);
    EXPECT_FALSE(words.has_begun());
    write("{\"begin\": {}}\n");
    words.read_more();
    EXPECT_TRUE(words.has_begun());
    EXPECT_FALSE(words.last_word());
}

TEST_F(WorkerWordsTest, IgnoresWrongTypesAndUnknownWords) {
    write("[[[[\n3\n{\"error\": []}\n{\"other\": 1}\n{\"phase\": 7, \"fraction\": \"x\"}\n");
    words.read_more();
    EXPECT_FALSE(words.last_word());
    EXPECT_EQ(progress, (std::vector<std::pair<std::string, double>>{{"", 0}}));
    write(R"({"error": {"kind": 5, "message": [], "field": {}}})"
          "\n");
    words.read_more();
    EXPECT_EQ(words.last_word()->error, ErrorKind::internal);
    EXPECT_EQ(words.last_word()->message, "");
}

TEST_F(WorkerWordsTest, StopsReadingAnEndlessLine) {
    write(std::string(2 << 20, 'x'));
    while (words.read_more()) {
    }
    EXPECT_TRUE(words.is_babbling());
    write("\n{\"done\": {}}\n");
    words.read_more();
    EXPECT_FALSE(words.last_word());
}

}  // namespace
}  // namespace hairbake
