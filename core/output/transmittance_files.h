// Transmittance per vertex and per point of the receiver as .npy, and as grey vertex colours of the model.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "core/hair/hair_model.h"
#include "core/output/file_sink.h"
#include "core/volume/transmittance.h"

namespace hairbake {

/// transmittance.npy: float32 [V] in the file's vertex order.
WrittenFile write_transmittance_npy(std::span<const float> average, const std::filesystem::path& folder);

/// What else the stage answered: transmittance_sh.npy [V, bands^2], bent_cone.npy [V, 4] and receiver.npy [R, 2], those
/// of them that `transmittance` holds, V and R in their files' order. `receiver` tells whether there is one; it may
/// have no positions.
std::vector<WrittenFile> write_directional_npy(const Transmittance& transmittance, int sh_bands, bool bent_cone,
                                               bool receiver, const std::filesystem::path& folder);

/// transmittance.hair: the model with A as grey vertex colours and nothing else changed.
WrittenFile write_transmittance_hair(const HairModel& model, std::span<const float> average,
                                     const std::filesystem::path& folder);

}  // namespace hairbake
