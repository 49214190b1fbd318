// The schema's list of outputs, its lists for each stage, and the table of writers must name the same formats.
#include "core/output/format_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace hairbake {
namespace {

TEST(FormatTable, HasAWriterForEveryOutputOfTheSchemaAndNoOther) {
    std::set<std::string> written;
    for (const FormatWriter& writer : format_writers)
        if (!writer.format.empty()) {
            EXPECT_TRUE(written.insert(std::string(writer.format)).second) << writer.format;
        }
    EXPECT_EQ(written, std::set<std::string>(output_formats().begin(), output_formats().end()));
}

TEST(FormatTable, EveryOutputBelongsToAStage) {
    std::set<std::string> of_stages;
    for (const Stage& stage : stages()) of_stages.insert(formats_of(stage).begin(), formats_of(stage).end());
    EXPECT_EQ(of_stages, std::set<std::string>(output_formats().begin(), output_formats().end()));
}

TEST(ArrayKinds, AreFoundByTheirNamesAndNamedOnce) {
    for (const ArrayKind& kind : array_kinds()) EXPECT_EQ(find_array_kind(kind.name), &kind);
    EXPECT_EQ(find_array_kind("nothing"), nullptr);
    EXPECT_EQ(average_transmittance_kind().name, "transmittance");
    EXPECT_EQ(bent_cone_kind().components(BakeRequest{}), 0u) << "a request without hair has no arrays";
}

}  // namespace
}  // namespace hairbake
