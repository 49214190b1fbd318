#include "core/reference/error_bar.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/visibility/direction_set.h"
#include "tests/core/reference/trace.h"
#include "tests/support/strand_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

TEST(ErrorStatistics, OfHandMadeNumbers) {
    // Errors 0.1, -0.1, 0.3, 0.1 (in float). Bias 0.4/4 = 0.1. Mean square (0.01 + 0.01 + 0.09 + 0.01)/4 = 0.03.
    // Variance 0.03 - 0.01 = 0.02: bias +- 1.96 sqrt(0.02/4) = 0.138593. Fourth powers: (3 x 0.0001 + 0.0081)/4 =
    // 0.0021; variance of the square 0.0021 - 0.0009 = 0.0012: 0.03 +- 1.96 sqrt(0.0012/4) = 0.033948, so the lower end
    // is cut off at 0.
    const std::vector<float> baked{0.6f, 0.4f, 0.8f, 0.6f}, traced(4, 0.5f);
    const ErrorFigures bar = error_statistics(baked, traced);
    constexpr double rounding = 1e-6;
    EXPECT_EQ(bar.vertices, 4u);
    EXPECT_NEAR(bar.bias, 0.1, rounding);
    EXPECT_NEAR(bar.rmse, std::sqrt(0.03), rounding);
    EXPECT_NEAR(bar.bias_ci95[0], 0.1 - 0.138593, rounding);
    EXPECT_NEAR(bar.bias_ci95[1], 0.1 + 0.138593, rounding);
    EXPECT_EQ(bar.rmse_ci95[0], 0);
    EXPECT_NEAR(bar.rmse_ci95[1], std::sqrt(0.063948), rounding);
}

TEST(ErrorStatistics, OfConstantErrorsHaveNoWidth) {
    const std::vector<float> baked(100, 0.25f), traced(100, 0.5f);
    const ErrorFigures bar = error_statistics(baked, traced);
    EXPECT_EQ(bar.bias, -0.25);
    EXPECT_EQ(bar.rmse, 0.25);
    EXPECT_EQ(bar.bias_ci95, (std::array{-0.25, -0.25}));
    EXPECT_EQ(bar.rmse_ci95, (std::array{0.25, 0.25}));
}

TEST(ErrorStatistics, OfNothingIsZero) {
    const ErrorFigures bar = error_statistics({}, TracedHalves{});
    EXPECT_EQ(bar.vertices, 0u);
    EXPECT_EQ(bar.rmse, 0);
    EXPECT_EQ(bar.bias_ci95, (std::array{0.0, 0.0}));
}

TEST(ErrorStatistics, IntervalsCoverTheTruthAsOftenAsTheySay) {
    // Errors uniform in [-0.05, 0.15]: bias 0.05, mean square 0.05^2 + 0.2^2/12 = 0.0058333. Over 2,000 samples of 256
    // the coverage of a 95 % interval has the standard error sqrt(0.95 x 0.05/2000) = 0.005; the normal approximation
    // at 256 costs less than 0.01.
    Random random(11);
    int bias_covered = 0, rmse_covered = 0;
    const std::vector<float> traced(256, 0.0f);
    for (int trial = 0; trial < 2000; ++trial) {
        std::vector<float> baked;
        for (std::size_t k = 0; k < traced.size(); ++k) baked.push_back(static_cast<float>(random.next(-0.05, 0.15)));
        const ErrorFigures bar = error_statistics(baked, traced);
        const double rmse = std::sqrt(0.0025 + 0.04 / 12);
        bias_covered += bar.bias_ci95[0] <= 0.05 && 0.05 <= bar.bias_ci95[1];
        rmse_covered += bar.rmse_ci95[0] <= rmse && rmse <= bar.rmse_ci95[1];
    }
    EXPECT_NEAR(bias_covered / 2000.0, 0.95, 4 * 0.005 + 0.01);
    EXPECT_NEAR(rmse_covered / 2000.0, 0.95, 4 * 0.005 + 0.01);
}

/// Ten strands of ten points in a row, and as the eleventh and twelfth a probe inside a strand and one in the open.
StrandGeometry row_of_strands() {
    StrandModel model;
    for (int s = 0; s < 10; ++s) model.add(straight({1.0 * s, 0, 0}, {1.0 * s, 9, 0}, 9), 0.2);
    model.add_probes({{3.05, 4.5, 0}, {3.5, 4.5, 0}});
    return model.geometry();
}

ErrorBar measure(const StrandGeometry& strands, const std::vector<float>& average, int count, std::uint64_t seed) {
    Progress progress;
    const StrandScene scene(strands, progress);
    return measure_error(scene, average, count, seed, progress);
}

TEST(MeasureError, TakesEveryVertexWhenThereAreNoMoreThanAskedForAndLeavesOutThoseInsideAnotherStrand) {
    const StrandGeometry strands = row_of_strands();
    Progress progress;
    const StrandScene scene(strands, progress);
    auto average = trace_reference(scene, all_vertices(strands), progress).mean();
    for (const int count : {102, 1000}) {
        const ErrorBar bar = measure(strands, average, count, 1);
        EXPECT_EQ(bar.outside.vertices, 101u);
        EXPECT_EQ(bar.clear.vertices, 101u);  // the rows are five widths apart
        EXPECT_EQ(bar.inside_strand, 1u);
        EXPECT_EQ(bar.directions, 4096);
        EXPECT_EQ(bar.outside.rmse, 0);  // the same rays
    }
    for (float& a : average) a += 0.125f;  // exact in binary for values that are multiples of 1/4096
    EXPECT_EQ(measure(strands, average, 102, 1).outside.bias, 0.125);
}

TEST(MeasureError, DrawsBySeedAndIsTheSameForAnyNumberOfThreads) {
    const StrandGeometry strands = row_of_strands();
    std::vector<float> average(strands.vertex_count());
    Random random(3);
    for (float& a : average) a = static_cast<float>(random.next());
    const auto rmse = [&](std::uint64_t seed) { return measure(strands, average, 30, seed).outside.rmse; };
    EXPECT_EQ(rmse(1), rmse(1));
    EXPECT_NE(rmse(1), rmse(2));
    const ErrorBar bar = measure(strands, average, 30, 1);
    EXPECT_EQ(bar.outside.vertices + bar.inside_strand, 30u);
    for (const int threads : {1, 2, 7}) with_threads(threads, [&] { EXPECT_EQ(rmse(1), bar.outside.rmse); });
}

TEST(MeasureError, OfNoVerticesIsEmpty) {
    const StrandGeometry strands = row_of_strands();
    EXPECT_EQ(measure(strands, std::vector<float>(strands.vertex_count(), 1.0f), 0, 1).outside.vertices, 0u);
    EXPECT_EQ(measure(StrandModel().geometry(), {}, 256, 1).outside.vertices, 0u);
}

TEST(MeasureError, CountsApartTheVerticesThatAreAWidthAwayFromOtherStrands) {
    // Two parallel strands, each of whose vertices is 0.75 widths from the other's surface, and a lone one: 30
    // vertices, 10 of them clear.
    StrandModel model;
    for (const double x : {0.0, 0.25, 5.0}) model.add(straight({x, 0, 0}, {x, 9, 0}, 9), 0.2);
    const StrandGeometry strands = model.geometry();
    const ErrorBar bar = measure(strands, std::vector<float>(strands.vertex_count(), 0.5f), 100, 1);
    EXPECT_EQ(bar.outside.vertices, 30u);
    EXPECT_EQ(bar.clear.vertices, 10u);
    EXPECT_EQ(bar.inside_strand, 0u);
    EXPECT_GT(std::abs(bar.clear.bias), std::abs(bar.outside.bias)) << "the lone strand is brighter";
}

TEST(ErrorStatistics, TheNoiseOfTheReferenceIsEstimatedFromItsHalvesAndTakenOff) {
    // Halves with independent errors of the standard deviation 0.04; the bake errs by 0.03 either way. The mean of the
    // halves has the noise 0.04 / sqrt(2). Over 20,000 vertices mean squares have relative standard errors of
    // sqrt(2 / 20000) = 0.01: four of them.
    Random random(7);
    const auto normal = [&] {  // of twelve uniform numbers, less their mean: the variance is 1
        double sum = -6;
        for (int i = 0; i < 12; ++i) sum += random.next();
        return sum;
    };
    std::vector<float> baked;
    TracedHalves traced;
    for (int k = 0; k < 20000; ++k) {
        baked.push_back(k % 2 ? 0.53f : 0.47f);
        traced.first.push_back(static_cast<float>(0.5 + 0.04 * normal()));
        traced.second.push_back(static_cast<float>(0.5 + 0.04 * normal()));
    }
    const ErrorFigures figures = error_statistics(baked, traced);
    EXPECT_NEAR(figures.noise * figures.noise, 0.0008, 0.04 * 0.0008);
    EXPECT_NEAR(figures.rmse * figures.rmse, 0.0009, 0.04 * (0.0009 + 2 * 0.0008));
    EXPECT_LT(figures.rmse_ci95[0], figures.rmse);
    EXPECT_GT(figures.rmse_ci95[1], figures.rmse);
}

TEST(ReferenceDirections, AreUnitVectorsUniformOverTheSphereAndNoneOfABakes) {
    const auto halves = make_reference_directions();
    ASSERT_EQ(halves[0].size() + halves[1].size(), 4096u);
    for (const auto& half : halves) {
        Vec3d sum;
        for (const Vec3d& l : half) {
            EXPECT_NEAR(length(l), 1, 1e-15);
            sum += l;
        }
        EXPECT_LT(length(sum) / double(half.size()), 1e-3);  // a Fibonacci set's first moment is O(1 / n)
    }
    for (const int count : {1024, 2048, 4096})
        for (const Vec3d& l : make_directions(DirectionSet::fibonacci, count, 0))
            for (const auto& half : halves)
                for (const Vec3d& other : half) ASSERT_GT(length(l - other), 1e-7);
}

TEST(MeasureError, StopsWhenItIsCancelled) {
    const StrandGeometry strands = row_of_strands();
    Progress progress, cancelled;
    const StrandScene scene(strands, progress);
    cancelled.cancel();
    const std::vector<float> average(strands.vertex_count(), 1.0f);
    EXPECT_THROW(measure_error(scene, average, 256, 1, cancelled), Error);
}

}  // namespace
}  // namespace hairbake
