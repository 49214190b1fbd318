// Everything that a bake gives, before it is written to files.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/environment/environment_map.h"
#include "core/hair/hair_file_extras.h"
#include "core/hair/hair_model.h"
#include "core/mesh/mesh_topology.h"
#include "core/mesh/triangle_mesh.h"
#include "core/request/request.h"
#include "core/result/stage_part.h"

namespace hairbake {

/// Facts of the hair model, kept when the model itself is not.
struct HairFacts {
    std::uint64_t strands = 0, vertices = 0, segments = 0;
    Vec3f bounds_min, bounds_max;  ///< of the points, model units
};

/// Facts of a mesh that was read.
struct MeshFacts {
    std::string format;  ///< of the file
    std::size_t positions = 0, triangles = 0;
    std::uint64_t faces = 0, concave_faces = 0, crossing_faces = 0;  ///< of the file
    std::uint64_t turned_triangles = 0;                              ///< by orient()
    MeshTopology topology;
    std::uint64_t vertices_looked_at = 0, vertices_inside = 0;  ///< of the hair (MeshFit)
};

/// Where a file was when it was read.
struct InputPath {
    std::string given, absolute;  ///< as the request names it, and from the root
};

/// The files that a bake read.
struct InputFacts {
    InputDigests digests;
    std::map<std::string, InputPath> paths;  ///< by name as the digests; empty where the bake is not to tell
    std::optional<HairFacts> hair;
    HairFileExtras hair_extras;  ///< of the hair's file, for transmittance.hair
    std::optional<MeshFacts> occluder, receiver;
    std::optional<EnvironmentMap> environment;  ///< without its pixels
};

/// The figures that differ between two runs of the same request. Everything else is the same bit for bit.
struct Measured {
    std::map<std::string, double> timings_s;  ///< wall seconds of each phase that ran
    std::uint64_t peak_memory_bytes = 0;      ///< of the process, as the kernel counts resident memory
    int threads = 0;
};

struct BakeResult {
    BakeRequest request;           ///< as run
    std::string id;                ///< bake_id()
    std::vector<StagePart> parts;  ///< of the stages that ran, in the order of stages()
    InputFacts inputs;
    std::optional<HairModel> hair;      ///< for the writers
    std::vector<std::string> warnings;  ///< of inputs, stages and output, for the person who asked for the bake
    Measured measured;

    /// Null where the stage did not run.
    const StagePart* part(std::string_view stage) const {
        for (const StagePart& part : parts)
            if (part.stage->name == stage) return &part;
        return nullptr;
    }
    /// The part that has an array of this kind, or null.
    const VertexArray* array(const ArrayKind& kind) const {
        for (const StagePart& part : parts)
            if (const VertexArray* found = find_array(part.arrays, kind)) return found;
        return nullptr;
    }
};

}  // namespace hairbake
