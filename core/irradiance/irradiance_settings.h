// The request's `irradiance` block: which maps are made, and how. The fibre model is a block of its own
// (core/fiber/fiber_settings.h), and so is the reading of the environment (core/environment/environment_settings.h).
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/base/names.h"
#include "core/environment/directional_light.h"

namespace hairbake {

enum class IrradianceMethod {
    exact,  ///< every pixel, through flux-centroid lights (light_set.h) and tabulated kernels (kernel_sum.h)
    sh      ///< zonal convolution in spherical harmonics (sh_maps.h)
};
inline constexpr std::array irradiance_method_names{
    EnumName{IrradianceMethod::exact, "exact"},
    EnumName{IrradianceMethod::sh, "sh"},
};

/// The request's `irradiance` block.
struct IrradianceSettings {
    int face_size = 16;      ///< texels per cube edge, 4 to 256
    int specular_maps = 33;  ///< M + 1, from 2 to 257; theta'_m = m pi / M
    IrradianceMethod method = IrradianceMethod::exact;
    std::optional<int> sh_bands_diffuse;  ///< 1 to 128 bands (l = 0 .. bands - 1); empty: auto from sh_error
    std::optional<int> sh_bands_specular;
    double sh_error = 0.01;                ///< target of auto: RMS / largest value of the lobe's maps, (0, 1]
    bool clamp_negative = true;            ///< sh only: negative texels become 0, their mass is reported
    std::vector<DirectionalLight> lights;  ///< at most 64; both methods add them to the maps with the exact kernel
};

}  // namespace hairbake
