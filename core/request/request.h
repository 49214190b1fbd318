// A bake request: plain structs, defaults and validation. The JSON form is in request_json.h.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/environment/environment_settings.h"
#include "core/fiber/fiber_settings.h"
#include "core/hair/strand_settings.h"
#include "core/irradiance/effective_settings.h"
#include "core/irradiance/irradiance_settings.h"
#include "core/visibility/transmittance_settings.h"

namespace hairbake {

/// Inputs, settings and outputs of a bake. At least one of `hair` and `environment` is given: hair alone bakes
/// transmittance, environment alone maps. The defaults here are the defaults everywhere (command line, HTTP, schema).
struct BakeRequest {
    std::optional<std::string> hair;         ///< path of a hair model
    std::optional<std::string> environment;  ///< path of an environment: a file, or a folder or pattern of six
    std::optional<std::string> occluder;     ///< path of a mesh that stops light completely; needs hair
    std::optional<std::string> receiver;     ///< path of a mesh that hair shadows; needs hair
    StrandSettings strand;
    TransmittanceSettings transmittance;
    EnvironmentSettings environment_settings;
    FiberSettings fiber;
    IrradianceSettings irradiance;
    EffectiveSettings effective_transmittance;
    std::vector<std::string> outputs{"npy", "exr", "hair"};  ///< of output_formats(); each at most once

    /// Whether `outputs` names `format`.
    bool wants(const std::string& format) const;
};

/// Names of the outputs, as the request's schema lists them: "npy", "exr" ...
const std::vector<std::string>& output_formats();

/// Throws Error(usage) naming the first field out of range, what was found and what is allowed. A request that passes
/// can still fail on its files (a voxel size that is absurd for the model, a width that the model lacks).
void validate(const BakeRequest& request);

}  // namespace hairbake
