// The contents of a HAIR file besides the model.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/vec.h"

namespace hairbake {

/// The parts of a HAIR header that no computation reads. The writer of HAIR files needs them to give back the same
/// bytes that were read. Kept beside the HairModel only where a HAIR file will be written.
struct HairFileExtras {
    std::array<char, 88> info{};     ///< the header's free text; need not end with a 0
    bool has_segments_array = true;  ///< false: every strand has default_segments segments
    std::uint32_t default_segments = 0;
    /// The header's defaults. The writer uses each one where the model has that array; otherwise it writes the default
    /// of the model. Such a default may be any bit pattern, NaN included.
    float default_thickness = 0, default_transparency = 0;
    Vec3f default_color{1, 1, 1};
    std::uint32_t empty_arrays = 0;  ///< V = 0 only: the file's bits for arrays that then have no entries
};

}  // namespace hairbake
