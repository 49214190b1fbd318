#include "core/reference/neighborhood_error.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/parallel.h"
#include "core/base/random.h"
#include "core/reference/tracer.h"
#include "core/visibility/direction_set.h"
#include "tests/core/reference/trace.h"
#include "tests/support/strand_models.h"

namespace hairbake {
namespace {

TEST(NeighborhoodFigures, AreThoseOfAStraightLine) {
    std::vector<double> baked, traced;
    for (int i = 0; i < 100; ++i) {
        traced.push_back(1 + 0.01 * i);
        baked.push_back(0.5 * traced.back() + 0.4);  // traced = 2 baked - 0.8
    }
    const NeighborhoodFigures figures = neighborhood_figures(baked, traced);
    const double mean = 1.495;
    EXPECT_NEAR(figures.slope, 2, 1e-12);
    EXPECT_NEAR(figures.bias, (0.5 * mean + 0.4 - mean) / mean, 1e-12);
    EXPECT_NEAR(figures.slope_ci95[0], 2, 1e-6);  // no point is off the line
    EXPECT_NEAR(figures.slope_ci95[1], 2, 1e-6);
    EXPECT_LT(figures.bias_ci95[0], figures.bias);
}

TEST(NeighborhoodFigures, TheIntervalsHoldTheTruthNineteenTimesInTwenty) {
    // 1,000 experiments: the count of misses has a standard error of 7, and the normal approximation of the slope's
    // interval with 50 points misses 5.6 % by Student's t. Four standard errors above that.
    Random random(5);
    int bias_missed = 0, slope_missed = 0;
    for (int experiment = 0; experiment < 1000; ++experiment) {
        std::vector<double> baked, traced;
        for (int i = 0; i < 50; ++i) {
            baked.push_back(random.next(1, 3));
            double noise = -6;  // of 12 uniform numbers: nearly normal, standard deviation 1
            for (int k = 0; k < 12; ++k) noise += random.next();
            traced.push_back(baked.back() + 0.3 * noise);
        }
        const NeighborhoodFigures figures = neighborhood_figures(baked, traced);
        bias_missed += figures.bias_ci95[0] > 0 || figures.bias_ci95[1] < 0;
        slope_missed += figures.slope_ci95[0] > 1 || figures.slope_ci95[1] < 1;
    }
    EXPECT_LT(bias_missed, 86);
    EXPECT_LT(slope_missed, 86);
    EXPECT_GT(bias_missed, 20);
    EXPECT_GT(slope_missed, 20);
}

TEST(NeighborhoodFigures, OfTooFewAreZero) {
    const std::vector<double> two{1, 2};
    EXPECT_EQ(neighborhood_figures(two, two).slope, 0);
    EXPECT_EQ(neighborhood_figures({}, {}).bias, 0);
}

struct Scene {
    StrandGeometry strands;
    std::vector<Vec3d> directions = make_directions(DirectionSet::fibonacci, 24, 0);
    std::vector<float> values;
    std::vector<std::uint32_t> rows;

    Scene() {
        Random random(3);
        test_support::StrandModel model;
        test_support::fill(model, test_support::ball(1), {-1, -1, -1}, {1, 1, 1}, {.extinction = 2}, random);
        strands = model.geometry();
        for (std::size_t k = 0; k < directions.size(); ++k) values.push_back(float(k + 1));
        rows.assign(strands.vertex_count(), 0);
    }
    DirectionWeights light() const { return {1, directions.size(), values, rows}; }
};

TEST(NeighborhoodError, OfTheTracedLightItselfIsNothing) {
    const Scene scene;
    Progress progress;
    const StrandScene traced(scene.strands, progress);
    const auto truth = trace_weighted(traced, all_vertices(scene.strands), scene.directions, scene.light(), progress);
    const NeighborhoodError error =
        measure_neighborhoods(traced, scene.directions, scene.light(), truth, 64, 1, progress);
    EXPECT_GT(error.neighborhoods, 50u);
    EXPECT_GT(error.vertices, 1000u);
    EXPECT_NEAR(error.effective.bias, 0, 1e-6);
    EXPECT_NEAR(error.effective.slope, 1, 1e-6);
    EXPECT_NEAR(error.effective.rmse, 0, 1e-6);
    EXPECT_GT(error.average.rmse, 0.02) << "A alone does not know where the light is";
}

TEST(NeighborhoodError, SeesAScaleOfTheBake) {
    const Scene scene;
    Progress progress;
    const StrandScene traced(scene.strands, progress);
    auto baked = trace_weighted(traced, all_vertices(scene.strands), scene.directions, scene.light(), progress);
    for (float& value : baked) value *= 1.25f;
    const NeighborhoodError error =
        measure_neighborhoods(traced, scene.directions, scene.light(), baked, 64, 1, progress);
    EXPECT_NEAR(error.effective.bias, 0.25, 1e-5);
    EXPECT_NEAR(error.effective.slope, 0.8, 1e-5);
}

TEST(NeighborhoodError, IsTheSameForAnyThreadCount) {
    const Scene scene;
    Progress progress;
    const StrandScene traced(scene.strands, progress);
    const std::vector<float> baked(scene.strands.vertex_count(), 100);
    std::vector<NeighborhoodError> errors;
    for (const int threads : {1, 2, 7})
        with_threads(threads, [&] {
            errors.push_back(measure_neighborhoods(traced, scene.directions, scene.light(), baked, 16, 2, progress));
        });
    for (const NeighborhoodError& error : errors) {
        EXPECT_EQ(error.vertices, errors[0].vertices);
        EXPECT_EQ(error.effective.bias, errors[0].effective.bias);
        EXPECT_EQ(error.average.rmse, errors[0].average.rmse);
    }
}

}  // namespace
}  // namespace hairbake
