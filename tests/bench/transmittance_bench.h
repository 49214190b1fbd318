// Models, settings and clocks that the tables of bench_transmittance share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/hair/strand_geometry.h"
#include "core/mesh/triangle_mesh.h"
#include "core/sample/groom_generator.h"
#include "core/volume/transmittance.h"

namespace hairbake::bench {

struct BenchOptions {
    bool quick = false;
    std::size_t vertices() const { return quick ? 200'000 : 1'500'000; }
    int reference_directions() const { return quick ? 1024 : 4096; }
};

/// Wall time of `work`.
double seconds(const std::function<void()>& work);

/// Seconds of the best of three runs: the machine is shared.
double best_of_three(const std::function<void()>& work);

StrandGeometry groom(GroomStyle style, std::size_t vertices);

/// Seconds of a bake by the volume method, the best of three. `result`, if any, gets the last bake.
double time_bake(const TransmittanceScene& scene, const TransmittanceSettings& settings,
                 Transmittance* result = nullptr);

/// 2,000 random vertices that are at least one width away from any strand that is not their own.
std::vector<std::uint32_t> scored_vertices(const StrandGeometry& strands);

/// `values` of these vertices.
std::vector<float> at(std::span<const std::uint32_t> vertices, std::span<const float> values);

// The tables, each printed as a whole: accuracy_tables.cpp, directional_tables.cpp, speed_tables.cpp,
// opacity_map_table.cpp, memory_table.cpp.
void accuracy_table(const BenchOptions& options);
void occluder_table(const BenchOptions& options);
void directional_tables(const BenchOptions& options);
void speed_tables(const BenchOptions& options);
void opacity_map_table();
void preset_table(const BenchOptions& options);
/// `program`: argv[0], which measures in processes of its own.
void memory_table(const std::string& program, const BenchOptions& options);
/// The work of such a process: prints one row. Returns the exit code.
int measure_memory(std::size_t vertices, int voxels);

}  // namespace hairbake::bench
