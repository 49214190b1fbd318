// The steps of the volume method one by one, to find where time goes: bench_steps [Google Benchmark's flags].
#include <benchmark/benchmark.h>

#include <array>
#include <cstdint>

#include "core/base/progress.h"
#include "core/sample/groom_generator.h"
#include "core/volume/density_grid.h"
#include "core/volume/hair_volume.h"
#include "core/volume/near_field.h"
#include "core/volume/point_slots.h"
#include "core/volume/slice_layout.h"
#include "core/volume/sweep.h"
#include "core/volume/weight_reader.h"

using namespace hairbake;

namespace {

/// A curly groom of 300,000 vertices with everything that the steps hand on, made once.
struct Groom {
    Progress progress;
    StrandGeometry strands;
    HairVolume volume;

    Groom() {
        GroomSettings settings;
        settings.style = GroomStyle::curly;
        settings.vertices = 300'000;
        strands = make_strand_geometry(generate_groom(settings), {});
        volume = make_hair_volume(strands, {}, progress);
    }

    PointSet vertices() const {
        return {.positions = volume.sorted.vertex_positions,
                .model_index = volume.sorted.vertices,
                .vectors = {},
                .shadow = nullptr};
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
    for (auto _ : state) benchmark::DoNotOptimize(sort_strands(groom.strands, groom.volume.frame, groom.progress));
    per_vertex(state);
}
BENCHMARK(sort_into_bricks)->Unit(benchmark::kMillisecond)->UseRealTime();

void deposit(benchmark::State& state) {
    Groom& groom = Groom::get();
    for (auto _ : state) benchmark::DoNotOptimize(deposit_strands(groom.volume.sorted, groom.progress));
    per_vertex(state);
}
BENCHMARK(deposit)->Unit(benchmark::kMillisecond)->UseRealTime();

void openvdb_grid(benchmark::State& state) {
    Groom& groom = Groom::get();
    for (auto _ : state) benchmark::DoNotOptimize(DensityGrid(groom.volume).occupied_voxels());
}
BENCHMARK(openvdb_grid)->Unit(benchmark::kMillisecond)->UseRealTime();

void lay_out_one_axis(benchmark::State& state) {
    Groom& groom = Groom::get();
    const PointSet vertices = groom.vertices();
    for (auto _ : state) {
        const SliceLayout layout = make_slice_layout(groom.volume, 1, groom.progress);
        benchmark::DoNotOptimize(make_point_slots(groom.volume, layout, vertices));
    }
    per_vertex(state);
}
BENCHMARK(lay_out_one_axis)->Unit(benchmark::kMillisecond)->UseRealTime();

/// One thread; items are vertex-directions.
void sweep_four_directions(benchmark::State& state) {
    Groom& groom = Groom::get();
    const SliceLayout layout = make_slice_layout(groom.volume, 1, groom.progress);
    const PointSet vertices = groom.vertices();
    const PointSlots slots = make_point_slots(groom.volume, layout, vertices);
    const std::vector<Vec3d> directions{normalized(Vec3d(0.1, 1, 0.2)), normalized(Vec3d(-0.5, 1, 0.3)),
                                        normalized(Vec3d(0.7, 1, -0.6)), normalized(Vec3d(-0.2, 1, -0.9))};
    const std::vector<std::uint32_t> walk{0, 1, 2, 3};
    // The average and its near field need four sums.
    const WeightReader reader(vertices, std::vector<float>(16, 0.5f), std::vector<float>(4, sweep_scale(1 << 20)));
    const std::array<const SweepReader*, 1> readers{&reader};
    SweepSums sums(slots.size(), 4);
    const SweepStop stop{slots, {}, readers, std::span(&sums, 1)};
    SweepScratch scratch;
    for (auto _ : state) sweep(layout, directions, walk, std::span(&stop, 1), scratch);
    per_vertex(state, 4);
}
BENCHMARK(sweep_four_directions)->Unit(benchmark::kMillisecond)->UseRealTime();

void near_field(benchmark::State& state) {
    Groom& groom = Groom::get();
    const std::vector<std::vector<AngularMean>> means{
        std::vector<AngularMean>(groom.strands.vertex_count(), AngularMean{0.4f, Vec3f(0.1f, 0.2f, -0.1f)})};
    for (auto _ : state)
        benchmark::DoNotOptimize(correct_near_field(groom.strands, groom.volume, means, groom.progress));
    per_vertex(state);
}
BENCHMARK(near_field)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
