#include "core/sample.h"

#include <gtest/gtest.h>

#include "core/base/digest.h"
#include "core/base/error.h"
#include "core/inspect.h"
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

TEST(Sample, PaperModelsHaveThePublishedVertexCounts) {
    const TemporaryFolder folder;
    Progress progress;
    SampleSettings settings = small();
    settings.paper_model = 2;
    const auto files = write_samples(folder / "a", settings, progress);
    EXPECT_NE(inspect(files[0], progress).find("\"vertices\": 687532"), std::string::npos);
}

TEST(Sample, FieldsOutOfRangeAreUsageErrors) {
    const TemporaryFolder folder;
    Progress progress;
    SampleSettings style = small(), model = small(), width = small();
    style.style = "bald";
    model.paper_model = 5;
    width.map_width = 15;
    for (const SampleSettings& settings : {style, model, width}) {
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
