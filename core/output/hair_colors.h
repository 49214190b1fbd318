// The hair model with A as grey vertex colours: transmittance.hair.
#pragma once

#include <filesystem>
#include <span>

#include "core/hair/hair_model.h"
#include "core/output/file_sink.h"

namespace hairbake {

/// transmittance.hair: the model with A as grey vertex colours and nothing else changed.
WrittenFile write_transmittance_hair(const HairModel& model, std::span<const float> average,
                                     const std::filesystem::path& folder);

}  // namespace hairbake
