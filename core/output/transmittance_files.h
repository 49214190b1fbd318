// Transmittance per vertex as .npy, and as grey vertex colours of the model.
#pragma once

#include <filesystem>
#include <span>

#include "core/hair/hair_model.h"
#include "core/output/file_sink.h"

namespace hairbake {

/// transmittance.npy: float32 [V] in the file's vertex order.
WrittenFile write_transmittance_npy(std::span<const float> average, const std::filesystem::path& folder);

/// transmittance.hair: the model with A as grey vertex colours and nothing else changed.
WrittenFile write_transmittance_hair(const HairModel& model, std::span<const float> average,
                                     const std::filesystem::path& folder);

}  // namespace hairbake
