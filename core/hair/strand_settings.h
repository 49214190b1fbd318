// The request's `strand` block.
#pragma once

#include <optional>

namespace hairbake {

/// Settings of the strands: widths, opacities and time.
struct StrandSettings {
    std::optional<double> width;     ///< strand diameter in model units for every point, instead of the file's; > 0
    double width_scale = 1;          ///< multiplies the width that is in use; > 0
    double opacity = 1;              ///< share of light that one strand crossing stops, [0, 1]
    bool opacity_from_file = false;  ///< take 1 - transparency of the file instead of `opacity`
    double time = 0;                 ///< seconds; which sample of an animated model. Models of one sample ignore it
};

}  // namespace hairbake
