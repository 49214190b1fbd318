#include "core/sample/groom_generator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <set>
#include <sstream>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/hair/hair_format_writer.h"
#include "core/sample/head_mesh.h"
#include "core/sample/head_shape.h"

namespace hairbake {
namespace {

constexpr GroomStyle styles[] = {GroomStyle::straight, GroomStyle::wavy, GroomStyle::curly};

std::string bytes_of(const GroomSettings& settings) {
    std::ostringstream stream;
    write_hair(generate_groom(settings), stream);
    return stream.str();
}

double strand_length(const HairModel& model, std::size_t s) {
    double sum = 0;
    for (std::uint32_t i = model.strand_begin[s]; i + 1 < model.strand_begin[s + 1]; ++i)
        sum += length(Vec3d(model.positions[i + 1]) - Vec3d(model.positions[i]));
    return sum;
}

TEST(GroomGenerator, GivesExactlyTheVerticesAskedFor) {
    // {vertices, per strand} -> strands = max(1, vertices / per strand), none for none.
    const std::uint64_t cases[][3] = {{0, 30, 0},  {1, 30, 1},  {29, 30, 1},   {30, 30, 1},
                                      {31, 30, 1}, {60, 30, 2}, {100, 30, 3},  {1009, 7, 144},
                                      {4, 2, 2},   {5, 2, 2},   {1000, 8, 125}};
    for (const auto& [vertices, per_strand, strands] : cases) {
        SCOPED_TRACE(vertices);
        const HairModel model = generate_groom({GroomStyle::wavy, vertices, static_cast<std::uint32_t>(per_strand), 3});
        EXPECT_EQ(model.vertex_count(), vertices);
        EXPECT_EQ(model.thickness.size(), vertices);
        ASSERT_EQ(model.strand_count(), strands);
        ASSERT_EQ(model.strand_begin.back(), vertices);
        // No strand differs from another by more than one vertex.
        std::set<std::uint32_t> sizes;
        for (std::size_t s = 0; s < strands; ++s) sizes.insert(model.strand_begin[s + 1] - model.strand_begin[s]);
        EXPECT_LE(sizes.size(), 2u);
        if (!sizes.empty()) {
            EXPECT_LE(*sizes.rbegin() - *sizes.begin(), 1u);
        }
    }
}

TEST(GroomGenerator, KnowsThePublishedModels) {
    const std::uint64_t published[] = {1'519'823, 687'532, 1'031'268, 872'756};  // the vertex counts of Xing 2012
    for (int number = 1; number <= 4; ++number) EXPECT_EQ(paper_model(number).vertices, published[number - 1]);
    EXPECT_THROW(paper_model(0), Error);
    EXPECT_THROW(paper_model(5), Error);
    EXPECT_EQ(generate_groom(paper_model(2)).vertex_count(), published[1]);
}

TEST(GroomGenerator, RefusesSettingsOutOfRangeNamingTheField) {
    const auto field_of = [](const GroomSettings& settings) -> std::string {
        try {
            generate_groom(settings);
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::usage);
            return error.field();
        }
        return "was accepted";
    };
    EXPECT_EQ(field_of({GroomStyle::straight, 1'000'000'001, 30, 1}), "vertices");
    EXPECT_EQ(field_of({GroomStyle::straight, 100, 1, 1}), "vertices_per_strand");
    EXPECT_EQ(field_of({GroomStyle::straight, 100, 65'536, 1}), "vertices_per_strand");
}

TEST(GroomGenerator, IsTheSameForAnyNumberOfThreads) {
    for (const GroomStyle style : styles) {
        const GroomSettings settings{style, 20'011, 25, 5};
        std::set<std::string> results;
        for (const int threads : {1, 2, 7}) with_threads(threads, [&] { results.insert(bytes_of(settings)); });
        EXPECT_EQ(results.size(), 1u);
    }
}

TEST(GroomGenerator, DiffersBySeedAndByStyle) {
    std::set<std::string> results;
    for (const GroomStyle style : styles)
        for (const std::uint64_t seed : {0u, 1u, 2u}) results.insert(bytes_of({style, 3000, 30, seed}));
    EXPECT_EQ(results.size(), 9u);
}

TEST(GroomGenerator, PutsNoVertexInsideTheHeadAndTheRootsOnItsSurface) {
    for (const GroomStyle style : styles) {
        const HairModel model = generate_groom({style, 60'000, 30, 7});
        for (const Vec3f& p : model.positions) ASSERT_GE(height_above_head(Vec3d(p)), 0);
        // A root is rounded to floats (half an ulp below 16 is 4.8e-7 in each coordinate) and then moved outwards in
        // steps that at most double: 1e-5 cm holds several times that.
        for (std::size_t s = 0; s < model.strand_count(); ++s) {
            const Vec3d root(model.positions[model.strand_begin[s]]);
            ASSERT_LE(height_above_head(root), 1e-5);
            ASSERT_TRUE(is_scalp(normalized(root)));
        }
    }
}

TEST(GroomGenerator, LiesOutsideTheHeadMeshToo) {
    // Independent of the shape's formula: the solid angle under which a closed mesh is seen is 0 from outside and
    // 4 pi from inside (van Oosterom and Strackee). Vertices from the fifth on keep 0.02 cm * min(1, 8 * 4/29) = 0.02
    // cm or more from the shape, the facets of the mesh stay within that of it under the hair.
    const TriangleMesh mesh = make_head_mesh();
    const auto solid_angle_from = [&](const Vec3d& eye) {
        double sum = 0;
        for (const auto& t : mesh.triangles) {
            const Vec3d a = normalized(Vec3d(mesh.positions[t[0]]) - eye),
                        b = normalized(Vec3d(mesh.positions[t[1]]) - eye),
                        c = normalized(Vec3d(mesh.positions[t[2]]) - eye);
            sum += 2 * std::atan2(dot(a, cross(b, c)), 1 + dot(a, b) + dot(b, c) + dot(c, a));
        }
        return sum;
    };
    // 36,480 triangles, each rounded to about 1e-15 and at most some 1e-9 where seen edge-on: 1e-4 in all is ample.
    EXPECT_NEAR(solid_angle_from({0, 0, 0}), 4 * std::numbers::pi, 1e-4);
    const HairModel model = generate_groom({GroomStyle::curly, 3000, 30, 7});
    for (std::size_t s = 0; s < model.strand_count(); ++s)
        EXPECT_NEAR(solid_angle_from(Vec3d(model.positions[model.strand_begin[s] + 4 + s % 26])), 0, 1e-4) << s;
}

TEST(GroomGenerator, GrowsStrandsOfHumanLengthAndWidth) {
    for (const GroomStyle style : styles) {
        const HairModel model = generate_groom({style, 60'000, 30, 7});
        double mean = 0;
        for (std::size_t s = 0; s < model.strand_count(); ++s) {
            const double cm = strand_length(model, s);
            ASSERT_GE(cm, 8) << s;  // drawn as 10 to 30 cm; drawing clumps together takes a little
            ASSERT_LE(cm, 32) << s;
            mean += cm / static_cast<double>(model.strand_count());
            // The root's diameter is 0.009 to 0.011 cm and the tip's 60 % of it.
            const float root = model.thickness[model.strand_begin[s]],
                        tip = model.thickness[model.strand_begin[s + 1] - 1];
            ASSERT_GE(root, 0.0089f);
            ASSERT_LE(root, 0.0111f);
            ASSERT_NEAR(tip, 0.6f * root, 1e-8f);
        }
        EXPECT_GT(mean, 15);
        EXPECT_LT(mean, 25);
        // Hair hangs: the mean height of the tips is well below that of the roots.
        double drop = 0;
        for (std::size_t s = 0; s < model.strand_count(); ++s)
            drop += double{model.positions[model.strand_begin[s]].y} -
                    double{model.positions[model.strand_begin[s + 1] - 1].y};
        EXPECT_GT(drop / static_cast<double>(model.strand_count()), 5);
    }
}

TEST(GroomGenerator, MakesNoSegmentOfZeroLengthAndNoStrandTwice) {
    for (const GroomStyle style : styles) {
        const HairModel model = generate_groom({style, 300'000, 30, 1});
        std::set<std::array<float, 6>> strands;  // root and second vertex
        for (std::size_t s = 0; s < model.strand_count(); ++s) {
            const Vec3f a = model.positions[model.strand_begin[s]], b = model.positions[model.strand_begin[s] + 1];
            strands.insert({a.x, a.y, a.z, b.x, b.y, b.z});
            for (std::uint32_t i = model.strand_begin[s]; i + 1 < model.strand_begin[s + 1]; ++i)
                ASSERT_GT(length(model.positions[i + 1] - model.positions[i]), 0.01f);
        }
        EXPECT_EQ(strands.size(), model.strand_count());
    }
}

}  // namespace
}  // namespace hairbake
