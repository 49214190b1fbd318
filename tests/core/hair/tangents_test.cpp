#include "core/hair/tangents.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hairbake {
namespace {

/// Tangents of a model with one strand for each list.
std::vector<Vec3f> tangents_of(const std::vector<std::vector<Vec3f>>& strands) {
    HairModel model;
    model.strand_begin = {0};
    for (const auto& strand : strands) {
        model.positions.insert(model.positions.end(), strand.begin(), strand.end());
        model.strand_begin.push_back(static_cast<std::uint32_t>(model.positions.size()));
    }
    return vertex_tangents(model);
}

void expect_near(const Vec3f& found, const Vec3f& expected) {
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(found[axis], expected[axis], 1e-7f);  // one float rounding
}

TEST(Tangents, PointFromRootToTipAlongTheNeighbours) {
    const float d = std::sqrt(0.5f);
    const auto tangents = tangents_of({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, {{5, 5, 5}, {5, 5, 3}}});
    expect_near(tangents[0], {1, 0, 0});
    expect_near(tangents[1], {d, d, 0});  // the chord from (0, 0, 0) to (1, 1, 0)
    expect_near(tangents[2], {0, 1, 0});
    expect_near(tangents[3], {0, 0, -1});
    expect_near(tangents[4], {0, 0, -1});
}

TEST(Tangents, LookPastPointsAtTheSamePlace) {
    const auto tangents = tangents_of({{{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 2, 0}, {1, 2, 0}}});
    expect_near(tangents[0], {1, 0, 0});
    expect_near(tangents[1], {1, 0, 0});
    for (int i : {2, 3, 4}) expect_near(tangents[i], Vec3f(1, 2, 0) * (1 / std::sqrt(5.0f)));
    for (int i : {5, 6}) expect_near(tangents[i], {0, 1, 0});
}

TEST(Tangents, OfAStrandWithoutExtentAreZeroAndOfATurnGoOn) {
    const auto tangents = tangents_of({{{3, 3, 3}}, {{1, 1, 1}, {1, 1, 1}}, {{0, 0, 0}, {2, 0, 0}, {0, 0, 0}}});
    for (int i : {0, 1, 2}) EXPECT_EQ(tangents[i], Vec3f());
    expect_near(tangents[4], {-1, 0, 0});
}

TEST(Tangents, HoldForCoordinatesAsLargeAndAsCloseAsFloatsAllow) {
    const auto tangents = tangents_of({{{-1e18f, 1e18f, 0}, {1e18f, 1e18f, 0}}, {{0, 0, 0}, {0, 1e-40f, 0}}});
    expect_near(tangents[0], {1, 0, 0});
    expect_near(tangents[3], {0, 1, 0});
    EXPECT_TRUE(tangents_of({}).empty());
}

}  // namespace
}  // namespace hairbake
