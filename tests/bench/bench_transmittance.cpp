// Accuracy, speed and memory of the transmittance stage, as plain tables.
//
//   bench_transmittance [--quick]      (--quick: models of 200,000 vertices, 1,024 reference directions)
//   bench_transmittance --speed        (the speed alone; with --quick after it: 200,000 vertices)
//   bench_transmittance --opacity-maps (layered deep opacity maps beside the volume method, 200,000 vertices)
//   bench_transmittance --presets      (draft, default and final on ten grooms; with --quick after it: 200,000
// vertices)
//   bench_transmittance --occluder     (the accuracy and time with an occluder alone)
//   bench_transmittance --directional  (harmonics, bent cones and receivers alone; with --quick after it: 200,000
//                                       vertices)
//
// Every ratio is taken within this run: the peers are timed on a sample of the same model's vertices and scaled.
#include <cstdio>
#include <cstdlib>
#include <string>

#include "core/base/parallel.h"
#include "tests/bench/transmittance_bench.h"

using namespace hairbake::bench;

int main(int argc, char** argv) {
    const std::string first = argc > 1 ? argv[1] : "", last = argv[argc - 1];
    if (argc == 4 && first == "--memory")
        return measure_memory(std::strtoull(argv[2], nullptr, 10), std::atoi(argv[3]));
    const BenchOptions options{last == "--quick"};
    std::printf("# Transmittance, %d threads\n", hairbake::thread_count());
    if (first == "--opacity-maps") {
        opacity_map_table();
    } else if (first == "--presets") {
        preset_table(options);
    } else if (first == "--occluder") {
        occluder_table(options);
    } else if (first == "--directional") {
        directional_tables(options);
    } else if (first == "--speed") {
        speed_tables(options);
    } else {
        speed_tables(options);
        memory_table(argv[0], options);
        accuracy_table(options);
        occluder_table(options);
        directional_tables(options);
    }
}
