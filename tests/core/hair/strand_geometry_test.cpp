#include "core/hair/strand_geometry.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/base/error.h"
#include "core/hair/hair_file.h"
#include "tests/support/hair_bytes.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

HairModel two_strands() { return read_hair(make_hair_bytes(31, {2, 1}), "two.hair"); }

/// The message and the field with which making the geometry fails as bad input.
std::pair<std::string, std::string> refusal(const HairModel& model, const StrandSettings& settings) {
    try {
        make_strand_geometry(model, settings);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::bad_input);
        return {error.what(), error.field()};
    }
    return {"was accepted", ""};
}

TEST(StrandGeometry, TakesWidthsFromTheFile) {
    const StrandGeometry geometry = make_strand_geometry(two_strands(), {});
    for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(geometry.widths[i], 0.01f + 0.001f * static_cast<float>(i));
    HairModel model = two_strands();
    model.thickness.clear();
    model.default_thickness = 0.02f;
    EXPECT_EQ(make_strand_geometry(model, {}).widths, std::vector<float>(5, 0.02f));
}

TEST(StrandGeometry, WidthOverridesTheFileAndWidthScaleMultipliesWhicheverHolds) {
    StrandSettings settings;
    settings.width = 0.5;
    EXPECT_EQ(make_strand_geometry(two_strands(), settings).widths, std::vector<float>(5, 0.5f));
    settings.width_scale = 0.25;
    EXPECT_EQ(make_strand_geometry(two_strands(), settings).widths, std::vector<float>(5, 0.125f));
    settings.width.reset();
    EXPECT_EQ(make_strand_geometry(two_strands(), settings).widths[4], (0.01f + 0.001f * 4) * 0.25f);
}

// Relatives of the tip: the root, both ends, a vertex between.
TEST(StrandGeometry, AStrandMayEndInAPointAndKeepsItsTaper) {
    for (const std::vector<float>& widths :
         {std::vector<float>{0.01f, 0.02f, 0}, {0, 0.02f, 0.01f}, {0, 0.02f, 0}, {0.02f, 0, 0.01f}}) {
        HairModel model = two_strands();
        std::copy(widths.begin(), widths.end(), model.thickness.begin());
        StrandSettings settings;
        settings.width_scale = 2;
        const StrandGeometry geometry = make_strand_geometry(model, settings);
        for (std::size_t i = 0; i < 3; ++i)
            EXPECT_EQ(geometry.widths[i], widths[i] > 0 ? 2 * widths[i] : least_width * 0.04f) << i;
        EXPECT_EQ(model.thickness[2], widths[2]);  // transmittance.hair has the file's widths
    }
}

// Relatives: all strands without a width, a negative width, NaN (which the readers refuse, too).
TEST(StrandGeometry, AsksForAWidthWhereTheFileGivesNone) {
    HairModel model = two_strands();
    model.thickness[3] = model.thickness[4] = 0;
    const auto [message, field] = refusal(model, {});
    EXPECT_NE(message.find("all vertices of strand 1 is 0"), std::string::npos) << message;
    EXPECT_NE(message.find("--width"), std::string::npos) << message;
    EXPECT_EQ(field, "strand.width");
    for (const float width : {-0.5f, std::numeric_limits<float>::quiet_NaN()}) {
        model.thickness[3] = 1;
        model.thickness[4] = width;
        EXPECT_NE(refusal(model, {}).first.find("strand 1, vertex 1 is " + std::string(width < 0 ? "-0.5" : "nan")),
                  std::string::npos)
            << refusal(model, {}).first;
    }
    std::fill(model.thickness.begin(), model.thickness.end(), 0.0f);
    EXPECT_NE(refusal(model, {}).first.find("all vertices of strand 0 is 0"), std::string::npos);
    model.thickness.clear();
    model.default_thickness = 0;
    EXPECT_NE(refusal(model, {}).first.find("--width"), std::string::npos);
    StrandSettings settings;
    settings.width = 0.01;
    EXPECT_NO_THROW(make_strand_geometry(model, settings));
}

TEST(StrandGeometry, RefusesWidthsThatAreNotPositiveAndFinite) {
    for (const double width : {0.0, -1.0, 1e300, 1e-300, std::numeric_limits<double>::quiet_NaN()}) {
        StrandSettings settings;
        settings.width = width;
        EXPECT_EQ(refusal(two_strands(), settings).second, "strand.width") << width;
    }
}

TEST(StrandGeometry, TakesOpacityFromTheRequestOrFromTheFile) {
    StrandSettings settings;
    settings.opacity = 0.5;
    EXPECT_EQ(make_strand_geometry(two_strands(), settings).opacities, std::vector<float>(5, 0.5f));
    settings.opacity_from_file = true;
    EXPECT_EQ(make_strand_geometry(two_strands(), settings).opacities, std::vector<float>(5, 0.75f));  // 1 - 0.25
    HairModel model = two_strands();
    model.transparency.clear();
    model.default_transparency = 0.125f;
    EXPECT_EQ(make_strand_geometry(model, settings).opacities, std::vector<float>(5, 0.875f));
    model.default_transparency = 1.5f;
    EXPECT_EQ(refusal(model, settings).second, "strand.opacity");
}

TEST(StrandGeometry, CountsSegmentsAndLeavesTheDegenerateOnesOut) {
    // The longest side of the bounds is 10, so segments shorter than 1e-6 * 10 = 1e-5 are degenerate. All x are near
    // enough to 0 that a float holds 0.9e-5 and 1.1e-5 to within 1e-12.
    HairModel model;
    model.strand_begin = {0, 4, 5, 7};
    model.positions = {{0, 0, 0}, {0, 0, 0}, {0.9e-5f, 0, 0}, {2.0e-5f, 0, 0}, {0, 10, 0}, {0, 0, 1}, {0, 0, 2}};
    model.default_thickness = 0.01f;
    const StrandGeometry geometry = make_strand_geometry(model, {});
    using enum Segment;
    EXPECT_EQ(geometry.segments, (std::vector{degenerate, degenerate, solid, none, none, solid, none}));
    EXPECT_EQ(geometry.segment_count, 4u);  // 3 + 0 + 1
    EXPECT_EQ(geometry.degenerate_segment_count, 2u);
    EXPECT_EQ(geometry.bounds_min, Vec3f(0, 0, 0));
    EXPECT_EQ(geometry.bounds_max, Vec3f(2.0e-5f, 10, 2));
}

TEST(StrandGeometry, TheSegmentsAtAVertexReachAcrossDegenerateOnes) {
    // Along y: 0, 0, 1, 1, 2, 3 in one strand, then a strand of one point and one of two. The segments of the first:
    // 0 degenerate, 1 solid, 2 degenerate, 3 solid, 4 solid.
    HairModel model;
    model.strand_begin = {0, 6, 7, 9};
    model.positions = {{0, 0, 0}, {0, 0, 0}, {0, 1, 0}, {0, 1, 0}, {0, 2, 0},
                       {0, 3, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}};
    model.default_thickness = 0.01f;
    const StrandGeometry geometry = make_strand_geometry(model, {});
    const std::vector<std::vector<std::uint32_t>> solid_at{{1}, {1}, {1, 3}, {1, 3}, {3, 4}, {4}, {}, {7}, {7}};
    for (std::uint32_t v = 0; v < solid_at.size(); ++v) {
        const OwnSegments adjacent = own_segments(geometry, v);
        std::vector<std::uint32_t> solid;
        for (std::uint32_t i = 0; i < solid_at.size(); ++i)
            if (adjacent.contains(i) && geometry.segments[i] == Segment::solid) solid.push_back(i);
        EXPECT_EQ(solid, solid_at[v]) << "vertex " << v;
    }
}

TEST(StrandGeometry, ModelsOfAnySizeKeepTheirSegments) {
    for (const float scale : {1e-30f, 1e-10f, 1.0f, 1e17f}) {
        HairModel model = two_strands();
        for (Vec3f& p : model.positions) p *= scale;
        EXPECT_EQ(make_strand_geometry(model, {}).degenerate_segment_count, 0u) << scale;
    }
}

/// Ten strands of 31 points, a unit apart, within 30 units.
HairModel ordinary_groom() {
    HairModel model;
    model.default_thickness = 0.01f;
    for (std::uint32_t s = 0; s <= 10; ++s) model.strand_begin.push_back(31 * s);
    for (int i = 0; i < 310; ++i) model.positions.emplace_back(float(i / 31), float(i % 31), 0.0f);
    return model;
}

TEST(StrandGeometry, APointSoFarOutThatTheStrandsCountAsDegenerateIsNamed) {
    // The bounds are 1e9 units, segments below 1e-6 of that, 1,000 units, are degenerate: of the 300 only the two at
    // the stray point are longer. Half-way cases: at 1e5 units a segment of one unit is ten times the shortest.
    HairModel model = ordinary_groom();
    model.positions[31 * 4 + 7].x = 1e9f;
    const std::string message = refusal(model, {}).first;
    EXPECT_NE(message.find("strand 4, vertex 7 lies 1e+09 units"), std::string::npos) << message;
    EXPECT_NE(message.find("298 of 300 segments"), std::string::npos) << message;
    model.positions[31 * 4 + 7].x = 1e5f;
    EXPECT_EQ(make_strand_geometry(model, {}).degenerate_segment_count, 0u);
}

TEST(StrandGeometry, AnOrdinaryGroomMayHaveDegenerateSegments) {
    // The bounds are 30 units: 1e-5 is below the shortest length, 3e-5. All points of a strand at one place have no
    // length and are no sign of a stray point, however many; of those with a length less than half are too short.
    HairModel model = ordinary_groom();
    for (std::size_t i = 0; i < 31 * 6; ++i) model.positions[i] = {float(i / 31), 0, 0};
    for (std::size_t s = 6; s < 9; ++s) model.positions[31 * s + 1].y = 1e-5f;
    const StrandGeometry geometry = make_strand_geometry(model, {});
    EXPECT_EQ(geometry.degenerate_segment_count, 6u * 30 + 3);
}

TEST(StrandGeometry, AGroomWhosePointsAllStandTwiceIsNoSignOfAStrayPoint) {
    // Each point again 1e-5 beside it, in 30 units: of the 61 segments of a strand of 62 points 31 are shorter than
    // 3e-5, more than half. No point is far out: the nearest half of them lies far beyond .3 units from the middle.
    const HairModel once = ordinary_groom();
    HairModel model = once;
    model.positions.clear();
    for (const Vec3f& p : once.positions)
        for (const float x : {0.0f, 1e-5f}) model.positions.push_back(p + Vec3f(x, 0, 0));
    for (std::uint32_t& begin : model.strand_begin) begin *= 2;
    EXPECT_EQ(make_strand_geometry(model, {}).degenerate_segment_count, 10u * 31);
}

TEST(StrandGeometry, HalfOfTheSegmentsMayBeTooShortAndNotMore) {
    // One strand along y of 10 units: segments of 1e-6 are below the shortest, 1e-5; floats near 0 hold them.
    HairModel model;
    model.default_thickness = 0.01f;
    model.strand_begin = {0, 5};
    model.positions = {{0, 0, 0}, {0, 1e-6f, 0}, {0, 2e-6f, 0}, {0, 5, 0}, {0, 10, 0}};
    EXPECT_EQ(make_strand_geometry(model, {}).degenerate_segment_count, 2u);
    model.positions[3].y = 3e-6f;
    // The median of y is 2e-6, so the last point is the farthest.
    EXPECT_NE(refusal(model, {}).first.find("strand 0, vertex 4 lies 10 units"), std::string::npos);
}

TEST(StrandGeometry, HoldsStrandsOfOnePointAndNoStrandsAtAll) {
    const StrandGeometry points = make_strand_geometry(read_hair(make_hair_bytes(31, {0, 0, 0}), "points.hair"), {});
    EXPECT_EQ(points.strand_count(), 3u);
    EXPECT_EQ(points.segment_count, 0u);
    EXPECT_EQ(points.segments, std::vector(3, Segment::none));
    EXPECT_EQ(make_strand_geometry(read_hair(make_hair_bytes(31, {}), "empty.hair"), {}).strand_count(), 0u);
    EXPECT_EQ(make_strand_geometry(HairModel{}, {}).strand_count(), 0u);
}

}  // namespace
}  // namespace hairbake
