#include "core/sample/sample.h"

#include <gtest/gtest.h>

#include "core/base/digest.h"
#include "core/base/error.h"
#include "core/tools/inspect.h"
#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

using test_support::TemporaryFolder;

SampleSettings small() {
    SampleSettings settings;
    settings.vertices = 600;
    settings.map_width = 32;
    return settings;
}

TEST(Sample, WritesFiveFilesThatAreTheSameForTheSameSeed) {
    const TemporaryFolder folder;
    Progress progress;
    const auto a = write_samples(folder / "a", small(), progress), b = write_samples(folder / "b", small(), progress);
    ASSERT_EQ(a.size(), 5u);
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(digest_of_file(a[i]), digest_of_file(b[i])) << a[i];
    SampleSettings other = small();
    other.seed = 2;
    const auto c = write_samples(folder / "c", other, progress);
    EXPECT_NE(digest_of_file(a[0]), digest_of_file(c[0]));
    EXPECT_NE(digest_of_file(a[2]), digest_of_file(c[2]));
}

/// Cancels itself when it is told of the second file.
class CancelAtTheHead : public Progress {
public:
    void report(double share) override {
        if (share > 0) cancel();
    }
};

TEST(Sample, ACancelOrAFailureLeavesWholeFilesOnly) {
    const TemporaryFolder folder;
    const auto names = [&] {
        std::vector<std::string> found;
        for (const auto& entry : std::filesystem::directory_iterator(folder / ""))
            found.push_back(entry.path().filename());
        return found;
    };
    CancelAtTheHead cancelled;
    EXPECT_THROW(write_samples(folder / "", small(), cancelled), Error);
    EXPECT_EQ(names(), std::vector<std::string>{"groom.hair"});
    // A folder of the head's name: the groom is replaced, the head is written and cannot take its place.
    std::filesystem::create_directories(folder / "head.obj" / "in the way");
    Progress progress;
    EXPECT_THROW(write_samples(folder / "", small(), progress), std::exception);
    EXPECT_FALSE(std::filesystem::exists(folder / ".part-head.obj"));
    EXPECT_EQ(names().size(), 2u);
}

TEST(Sample, PaperModelsHaveThePublishedVertexCounts) {
    const TemporaryFolder folder;
    Progress progress;
    SampleSettings settings = small();
    settings.paper_model = 2;
    const auto files = write_samples(folder / "a", settings, progress);
    EXPECT_NE(inspect(files[0], progress).find("\"vertices\": 687532"), std::string::npos);
}

TEST(Sample, StylesHaveTheirNames) {
    for (const NamedGroomStyle& named : groom_styles) {
        EXPECT_EQ(groom_style_named(named.name), named.style);
        EXPECT_EQ(name_of(named.style), named.name);
    }
    try {
        groom_style_named("bald");
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::usage);
        EXPECT_EQ(error.field(), "style");
        EXPECT_STREQ(error.what(), "style is \"bald\"; allowed is one of straight, wavy, curly");
    }
}

TEST(Sample, FieldsOutOfRangeAreUsageErrors) {
    const TemporaryFolder folder;
    Progress progress;
    SampleSettings model = small(), width = small();
    model.paper_model = 5;
    width.map_width = 15;
    for (const SampleSettings& settings : {model, width}) {
        try {
            write_samples(folder / "a", settings, progress);
            ADD_FAILURE();
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::usage) << error.what();
        }
    }
}

}  // namespace
}  // namespace hairbake
