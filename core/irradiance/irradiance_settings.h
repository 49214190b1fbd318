// The request's `irradiance` block: which maps are made, and how.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/environment/directional_light.h"

namespace hairbake {

enum class IrradianceMethod {
    exact,  ///< every pixel, through flux-centroid lights (light_set.h) and tabulated kernels (kernel_sum.h)
    sh      ///< zonal convolution in spherical harmonics (sh_maps.h)
};

/// The request's `irradiance` block.
struct IrradianceSettings {
    std::string model = "kajiya-kay";
    int face_size = 16;      ///< texels per cube edge, 4 to 256
    int specular_maps = 33;  ///< M + 1, from 2 to 257; theta'_m = m pi / M
    double exponent = 64;    ///< Kajiya-Kay p, 0 to 4096
    IrradianceMethod method = IrradianceMethod::exact;
    std::optional<int> sh_bands_diffuse;  ///< 1 to 128 bands (l = 0 .. bands - 1); empty: auto from sh_error
    std::optional<int> sh_bands_specular;
    double sh_error = 0.01;                ///< target of auto: RMS over the largest value of all maps, (0, 1]
    bool clamp_negative = true;            ///< sh only: negative texels become 0, their mass is reported
    std::vector<DirectionalLight> lights;  ///< at most 64; both methods add them to the maps with the exact kernel
};

}  // namespace hairbake
