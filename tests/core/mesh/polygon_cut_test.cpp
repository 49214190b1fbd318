#include "core/mesh/polygon_cut.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/base/random.h"
#include "tests/support/mesh_bytes.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

struct Cut {
    PolygonKind kind;
    std::vector<Triangle> triangles;
};

/// The polygon with these corners, begun at corner `begin`.
Cut cut(const std::vector<Vec3f>& corners, std::size_t begin = 0) {
    std::vector<std::uint32_t> polygon(corners.size());
    std::iota(polygon.begin(), polygon.end(), 0u);
    std::rotate(polygon.begin(), polygon.begin() + static_cast<std::ptrdiff_t>(begin), polygon.end());
    Cut result;
    result.kind = PolygonCutter().cut(corners, polygon, result.triangles);
    return result;
}

/// Sum of the triangles' areas, each with the sign of its side along z.
double area_along_z(const std::vector<Vec3f>& corners, const std::vector<Triangle>& triangles) {
    double sum = 0;
    for (const Triangle& t : triangles) {
        const Vec3d a(corners[t[0]]), b(corners[t[1]]), c(corners[t[2]]);
        sum += cross(b - a, c - a).z / 2;
    }
    return sum;
}
double unsigned_area(const std::vector<Vec3f>& corners, const std::vector<Triangle>& triangles) {
    double sum = 0;
    for (const Triangle& t : triangles) {
        const Vec3d a(corners[t[0]]), b(corners[t[1]]), c(corners[t[2]]);
        sum += length(cross(b - a, c - a)) / 2;
    }
    return sum;
}

TEST(PolygonCut, AConvexPolygonIsTheFanAboutItsFirstCorner) {
    const std::vector<Vec3f> hexagon{{2, 0, 1}, {1, 2, 1}, {-1, 2, 1}, {-2, 0, 1}, {-1, -2, 1}, {1, -2, 1}};
    for (std::uint32_t begin = 0; begin < 6; ++begin) {
        const Cut found = cut(hexagon, begin);
        EXPECT_EQ(found.kind, PolygonKind::convex);
        ASSERT_EQ(found.triangles.size(), 4u);
        EXPECT_EQ(found.triangles[0], (Triangle{begin, (begin + 1) % 6, (begin + 2) % 6}));
    }
    // Corners on a side, and a quad that is not flat but convex along its mean normal.
    EXPECT_EQ(cut({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}}).kind, PolygonKind::convex);
    EXPECT_EQ(cut({{0, 0, 0}, {1, 0, 0.3f}, {1, 1, 0}, {0, 1, 0.3f}}).kind, PolygonKind::convex);
}

// Two triangles of a simple polygon never overlap: then the unsigned areas add up to the polygon's own area, which the
// shoelace formula gives.
TEST(PolygonCut, RandomStarsAreCoveredOnceFromEveryCorner) {
    Random random(5);
    for (int round = 0; round < 200; ++round) {
        std::vector<Vec3f> star;
        const int count = 5 + round % 20;
        double shoelace = 0;
        for (int k = 0; k < count; ++k) {
            const double angle = 2 * std::numbers::pi * k / count, radius = random.next(0.2, 1);
            star.emplace_back(Vec3d(radius * std::cos(angle), radius * std::sin(angle), 0.25));
        }
        for (std::size_t k = 0; k < star.size(); ++k)
            shoelace += cross(Vec3d(star[k]), Vec3d(star[(k + 1) % star.size()])).z / 2;
        for (const std::size_t begin : {std::size_t{0}, star.size() / 2, star.size() - 1}) {
            const Cut found = cut(star, begin);
            EXPECT_NE(found.kind, PolygonKind::crossing);
            EXPECT_EQ(found.triangles.size(), star.size() - 2);
            EXPECT_NEAR(area_along_z(star, found.triangles), shoelace, 1e-6);  // of single precision
            EXPECT_NEAR(unsigned_area(star, found.triangles), shoelace, 1e-6);
        }
    }
}

// Relatives of the concave face: an arrow of four corners, a hole that a bridge joins to the outline (its ends are there
// twice), a face that is concave and not flat.
TEST(PolygonCut, ArrowsBridgedHolesAndBentFacesAreConcave) {
    const std::vector<Vec3f> arrow{{0, 0, 0}, {2, 1, 0}, {0, 2, 0}, {0.5f, 1, 0}};
    for (std::size_t begin = 0; begin < 4; ++begin) {
        EXPECT_EQ(cut(arrow, begin).kind, PolygonKind::concave);
        EXPECT_NEAR(unsigned_area(arrow, cut(arrow, begin).triangles), 1.5, 1e-6);
    }
    const std::vector<Vec3f> ring{{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0}, {0, 0, 0},
                                  {1, 1, 0}, {1, 2, 0}, {2, 2, 0}, {2, 1, 0}, {1, 1, 0}};
    for (std::size_t begin = 0; begin < ring.size(); ++begin) {
        EXPECT_EQ(cut(ring, begin).kind, PolygonKind::concave) << begin;
        EXPECT_NEAR(unsigned_area(ring, cut(ring, begin).triangles), 8, 1e-5) << begin;
    }
    const std::vector<Vec3f> bent{{0, 0, 0}, {3, 0, 0.1f}, {3, 1, 0}, {1, 1, 0.1f}, {1, 3, 0}, {0, 3, 0.1f}};
    for (std::size_t begin = 0; begin < bent.size(); ++begin) {
        EXPECT_EQ(cut(bent, begin).kind, PolygonKind::concave);
        EXPECT_NEAR(area_along_z(bent, cut(bent, begin).triangles), 5, 1e-5);
    }
}

TEST(PolygonCut, CrossingOutlinesAreFansThatDoNotDependOnTheFirstCorner) {
    std::vector<Vec3f> bow{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1.5f, 0}};
    std::vector<Vec3f> equal_bow{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}};  // its areas cancel
    std::vector<Vec3f> pentagram;
    for (int k = 0; k < 5; ++k)
        pentagram.emplace_back(
            Vec3d(std::cos(4 * std::numbers::pi * k / 5), std::sin(4 * std::numbers::pi * k / 5), 0));
    for (const auto* outline : {&bow, &equal_bow, &pentagram}) {
        const Cut expected = cut(*outline);
        EXPECT_EQ(expected.kind, PolygonKind::crossing);
        for (std::size_t begin = 1; begin < outline->size(); ++begin)
            EXPECT_EQ(cut(*outline, begin).triangles, expected.triangles);
    }
}

TEST(PolygonCut, NeverNamesAnIndexTwiceInATriangle) {
    const std::vector<Vec3f> line{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 0, 0}};
    EXPECT_EQ(cut(line).kind, PolygonKind::convex);
    std::vector<Triangle> triangles;
    PolygonCutter().cut(line, std::vector<std::uint32_t>{0, 0, 1, 1, 2, 2}, triangles);
    EXPECT_EQ(triangles, (std::vector<Triangle>{{0, 1, 2}}));
}

}  // namespace
}  // namespace hairbake
