// Peak memory of a bake by the volume method, each in a process of its own.
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <utility>

#include "tests/bench/transmittance_bench.h"

namespace hairbake::bench {
namespace {

double peak_megabytes() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.rfind("VmHWM:", 0) == 0) return std::atof(line.c_str() + 6) / 1024;
    return 0;
}

}  // namespace

int measure_memory(std::size_t vertices, int voxels) {
    const StrandGeometry strands = groom(GroomStyle::wavy, vertices);
    const double before = peak_megabytes();
    TransmittanceSettings settings;
    settings.voxels = voxels;
    Progress progress;
    const Transmittance baked = bake_transmittance_volume({strands}, settings, progress);
    const double occupied = double(baked.occupied_voxels);
    std::printf("| %zu | %d | %.0f | %.0f | %.1f | %.0f |\n", vertices, voxels, before, peak_megabytes(),
                occupied * 1e-6, (peak_megabytes() - before) * 1e6 / occupied);
    return 0;
}

void memory_table(const std::string& program, const BenchOptions& options) {
    std::printf(
        "\n## Peak memory, without the reference scene\n\n| vertices | voxels | model alone, MB | with bake, MB | "
        "occupied voxels, M | "
        "bytes per occupied voxel |\n|---|---|---|---|---|---|\n");
    std::fflush(stdout);
    for (const auto& [vertices, voxels] :
         {std::pair{3'100'000, 256}, std::pair{3'100'000, 512}, std::pair{1'500'000, 512}}) {
        const std::string command = program + " --memory " + std::to_string(options.quick ? vertices / 10 : vertices) +
                                    " " + std::to_string(voxels);
        if (std::system(command.c_str()) != 0) std::printf("| failed: %s |\n", command.c_str());
    }
}

}  // namespace hairbake::bench
