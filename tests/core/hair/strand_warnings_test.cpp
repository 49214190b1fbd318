#include "core/hair/strand_warnings.h"

#include <gtest/gtest.h>

namespace hairbake {
namespace {

/// Strands of three points each, one unit apart, begun at these places.
StrandGeometry strands_at(const std::vector<Vec3f>& roots) {
    HairModel model;
    model.strand_begin = {0};
    model.default_thickness = 0.01f;
    for (const Vec3f& root : roots) {
        for (int i = 0; i < 3; ++i) model.positions.push_back(root + Vec3f(0, float(i), 0));
        model.strand_begin.push_back(static_cast<std::uint32_t>(model.positions.size()));
    }
    return make_strand_geometry(model, {});
}

TEST(StrandWarnings, OrdinaryStrandsHaveNone) {
    EXPECT_TRUE(strand_warnings(strands_at({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}})).empty());
    // Joined ends are no duplicates, nor are strands of one point.
    EXPECT_TRUE(strand_warnings(strands_at({{0, 0, 0}, {0, 2, 0}})).empty());
}

TEST(StrandWarnings, StrandsOfTheSamePointsAreCountedAndTheFirstIsNamed) {
    const auto warnings =
        strand_warnings(strands_at({{5, 0, 0}, {1, 0, 0}, {5, 0, 0}, {5, 0, 0}, {2, 0, 0}, {1, 0, 0}}));
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_TRUE(warnings[0].starts_with("3 strands have the same points as another strand, the first of them strand 2"))
        << warnings[0];
}

TEST(StrandWarnings, AModelWithoutVerticesAndOneFarFromTheOriginAreToldOf) {
    EXPECT_EQ(strand_warnings(strands_at({})), std::vector<std::string>{"the hair model has no vertex"});
    EXPECT_TRUE(strand_warnings(strands_at({{90000, 0, 0}, {90001, 0, 0}})).empty()) << "45,000 sizes of 2 units";
    const auto warnings = strand_warnings(strands_at({{500000, 0, 0}, {500001, 0, 0}}));
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find("times its own size from the origin"), std::string::npos) << warnings[0];
}

}  // namespace
}  // namespace hairbake
