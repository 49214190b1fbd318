// The result of one stage of a bake.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/environment/light_clusters.h"
#include "core/reference/error_bar.h"
#include "core/reference/neighborhood_error.h"
#include "core/request/stages.h"
#include "core/result/map_set.h"
#include "core/result/vertex_array.h"
#include "core/volume/transmittance.h"

namespace hairbake {

/// Facts about how the transmittance was computed.
struct TransmittanceFacts {
    TransmittanceMethod method = TransmittanceMethod::volume;  ///< the one that ran, never automatic
    std::string method_reason;                                 ///< why it ran
    int directions = 0;
    double voxel_size = 0;                          ///< effective h in model units; 0 without voxels
    VoxelReason voxel_reason = VoxelReason::asked;  ///< with voxels
    std::uint64_t occupied_voxels = 0;              ///< 0 without voxels
    std::uint64_t degenerate_segments = 0;
    std::optional<ErrorBar> error_bar;           ///< with reference_vertices > 0
    std::shared_ptr<const DensityGrid> density;  ///< extinction of the sweep; null unless density.vdb is asked for
};

/// Facts about how the maps were computed: IrradianceMaps without its maps (irradiance_maps.h says what each means).
struct IrradianceFacts {
    std::vector<Vec3d> environment_sh;
    int environment_sh_bands = 0;
    Vec3d interpolation_bound;
    double interpolation_bound_relative = 0;
    bool from_sh = false;  ///< by the method sh; only then the next four count
    int sh_bands_diffuse = 0, sh_bands_specular = 0;
    double predicted_error_diffuse = 0, predicted_error_specular = 0;
};

/// Facts about the effective transmittance.
struct EffectiveFacts {
    TransmittanceMethod method = TransmittanceMethod::volume;  ///< the one that ran
    std::string method_reason;
    std::vector<ClusteredLight> lights;
    int diffuse_components = 3, cosines = 3;
    int face_size = 0;                       ///< of the cube of tangent cells
    std::optional<NeighborhoodError> error;  ///< with reference_neighborhoods > 0
};

/// A stage that has something to tell in the manifest adds a struct of facts here, and a function in
/// core/output/manifest_stages.cpp that describes it.
using StageFacts = std::variant<std::monostate, TransmittanceFacts, IrradianceFacts, EffectiveFacts>;

struct StagePart {
    const Stage* stage = nullptr;
    std::string key;  ///< stage_key()
    std::vector<VertexArray> arrays;
    std::optional<MapSet> maps;
    StageFacts facts;
    std::vector<std::string> warnings;  ///< for the person who asked for the bake
};

}  // namespace hairbake
