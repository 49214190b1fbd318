// Traces a model in one call.
#pragma once

#include <vector>

#include "core/reference/strand_scene.h"
#include "core/reference/tracer.h"
#include "core/visibility/direction_set.h"

namespace hairbake::test_support {

inline std::vector<float> trace(const StrandGeometry& strands, const std::vector<std::uint32_t>& vertices,
                                const std::vector<Vec3d>& directions) {
    Progress progress;
    const StrandScene scene(strands, progress);
    return trace_transmittance(scene, vertices, directions, progress);
}

/// `sets` stratified sets of 64 x 64 directions each, with the seeds 1, 2, ...
inline std::vector<Vec3d> many_directions(int sets) {
    std::vector<Vec3d> all;
    for (int seed = 1; seed <= sets; ++seed) {
        const auto set = make_directions(DirectionSet::stratified, 4096, static_cast<std::uint64_t>(seed));
        all.insert(all.end(), set.begin(), set.end());
    }
    return all;
}

}  // namespace hairbake::test_support
