// Everything that a bake gives, before it is written to files.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/environment/environment_map.h"
#include "core/hair/hair_model.h"
#include "core/irradiance/irradiance_maps.h"
#include "core/mesh/mesh_topology.h"
#include "core/mesh/triangle_mesh.h"
#include "core/reference/error_bar.h"
#include "core/request/request.h"
#include "core/request/stages.h"
#include "core/volume/transmittance.h"

namespace hairbake {

/// Facts of the hair model, kept when the model itself is not.
struct HairFacts {
    std::uint64_t strands = 0, vertices = 0, segments = 0;
    std::uint64_t degenerate_segments = 0;  ///< so short that they carry no extinction
    Vec3f bounds_min, bounds_max;           ///< of the points, model units
};

/// What differs between two runs of the same request; everything else is the same bit for bit.
struct Measured {
    /// Wall seconds of read_hair, transmittance, reference, read_environment, irradiance and write; 0 for what did
    /// not run.
    std::map<std::string, double> timings_s{{"read_hair", 0},        {"transmittance", 0}, {"reference", 0},
                                            {"read_environment", 0}, {"irradiance", 0},    {"write", 0}};
    std::uint64_t peak_memory_bytes = 0;  ///< of the process, as the kernel counts resident memory
    int threads = 0;
};

struct BakeResult {
    BakeRequest request;   ///< as run
    std::string id;        ///< bake_id()
    InputDigests digests;  ///< of the files that were read
    StageKeys keys;        ///< of the stages that ran

    // The transmittance stage; empty without hair.
    HairFacts hair_facts;
    std::optional<HairModel> hair;  ///< kept only where the outputs need it
    std::optional<TriangleMesh> occluder;
    MeshTopology occluder_topology;  ///< with an occluder
    std::optional<TriangleMesh> receiver;
    std::optional<Transmittance> transmittance;
    std::optional<ErrorBar> error_bar;  ///< with reference_vertices > 0

    // The irradiance stage; empty without environment.
    std::optional<EnvironmentMap> environment;  ///< facts; the pixels are dropped after the stage
    std::optional<IrradianceMaps> irradiance;

    std::vector<std::string> warnings;  ///< of the stages and of the output, for the person who asked for the bake
    Measured measured;
};

}  // namespace hairbake
