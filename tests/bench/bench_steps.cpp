// The steps of both stages one by one, for finding where time goes: bench_steps [Google Benchmark's flags].
#include <benchmark/benchmark.h>

#include <array>
#include <cstdint>

#include "core/base/progress.h"
#include "core/sample/groom_generator.h"
#include "core/volume/density_grid.h"
#include "core/volume/near_field.h"
#include "core/volume/slice_layout.h"
#include "core/volume/sweep.h"

using namespace hairbake;

namespace {

/// A curly groom of 300,000 vertices with everything that the steps hand on, made once.
struct Groom {
    Progress progress;
    StrandGeometry strands;
    GridFrame frame;
    SortedStrands sorted;
    ExtinctionBricks bricks;

    Groom() {
        GroomSettings settings;
        settings.style = GroomStyle::curly;
        settings.vertices = 300'000;
        strands = make_strand_geometry(generate_groom(settings), {});
        bool bounded = false;
        frame = make_grid_frame(strands, {}, &bounded);
        sorted = sort_strands(strands, frame, progress);
        bricks = deposit_strands(sorted, progress);
    }

    static Groom& get() {
        static Groom groom;
        return groom;
    }
};

void per_vertex(benchmark::State& state, std::int64_t terms = 1) {
    state.SetItemsProcessed(state.iterations() * terms *
                            static_cast<std::int64_t>(Groom::get().strands.vertex_count()));
}

void sort_into_bricks(benchmark::State& state) {
    Groom& groom = Groom::get();
    for (auto _ : state) benchmark::DoNotOptimize(sort_strands(groom.strands, groom.frame, groom.progress));
    per_vertex(state);
}
BENCHMARK(sort_into_bricks)->Unit(benchmark::kMillisecond)->UseRealTime();

void deposit(benchmark::State& state) {
    Groom& groom = Groom::get();
    for (auto _ : state) benchmark::DoNotOptimize(deposit_strands(groom.sorted, groom.progress));
    per_vertex(state);
}
BENCHMARK(deposit)->Unit(benchmark::kMillisecond)->UseRealTime();

void openvdb_grid(benchmark::State& state) {
    Groom& groom = Groom::get();
    for (auto _ : state)
        benchmark::DoNotOptimize(DensityGrid(groom.frame, groom.sorted, groom.bricks).occupied_voxels());
}
BENCHMARK(openvdb_grid)->Unit(benchmark::kMillisecond)->UseRealTime();

void lay_out_one_axis(benchmark::State& state) {
    Groom& groom = Groom::get();
    for (auto _ : state)
        benchmark::DoNotOptimize(make_slice_layout(groom.frame, groom.sorted, groom.bricks, 1, groom.progress));
    per_vertex(state);
}
BENCHMARK(lay_out_one_axis)->Unit(benchmark::kMillisecond)->UseRealTime();

/// One thread; items are vertex-directions.
void sweep_four_directions(benchmark::State& state) {
    Groom& groom = Groom::get();
    const SliceLayout layout = make_slice_layout(groom.frame, groom.sorted, groom.bricks, 1, groom.progress);
    const std::vector<Vec3d> lights{normalized(Vec3d(0.1, 1, 0.2)), normalized(Vec3d(-0.5, 1, 0.3)),
                                    normalized(Vec3d(0.7, 1, -0.6)), normalized(Vec3d(-0.2, 1, -0.9))};
    const std::array<double, 4> weights{1, 0.5, 0.5, -0.5};  // the sums of A and of its near field are four
    std::vector<SweepDirection> directions;
    for (const Vec3d& l : lights) directions.push_back({l, weights});
    SweepScratch scratch;
    SweepTotals totals;
    totals.vertices = SweepSums(layout.slot_vertex.size(), weights.size());
    for (auto _ : state) sweep(layout, nullptr, directions, sweep_scale(1 << 20), {}, scratch, totals);
    per_vertex(state, 4);
}
BENCHMARK(sweep_four_directions)->Unit(benchmark::kMillisecond)->UseRealTime();

void near_field(benchmark::State& state) {
    Groom& groom = Groom::get();
    const std::vector<AngularMean> means(groom.strands.vertex_count(), AngularMean{0.4f, Vec3f(0.1f, 0.2f, -0.1f)});
    for (auto _ : state)
        benchmark::DoNotOptimize(
            correct_near_field(groom.strands, groom.frame, groom.sorted, groom.bricks, means, groom.progress));
    per_vertex(state);
}
BENCHMARK(near_field)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
