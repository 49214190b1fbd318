#include "core/volume/grid_frame.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/assert.h"
#include "core/base/error.h"
#include "core/base/short_number.h"
#include "core/volume/strand_spacing.h"

namespace hairbake {

double typical_largest_width(const std::vector<float>& widths) {
    HAIRBAKE_ASSERT(!widths.empty());
    // A sample at regular steps would be wrong: the width depends on the place in the strand, and the steps may fall on
    // the same place of every strand.
    std::vector<float> ordered = widths;
    const std::size_t rank = (ordered.size() - 1) * 95 / 100;
    std::nth_element(ordered.begin(), ordered.begin() + static_cast<std::ptrdiff_t>(rank), ordered.end());
    return ordered[rank];
}

namespace {

/// Sets voxel_size and reason as the settings ask, without regard to the widths.
void ask_for_voxels(const StrandGeometry& strands, const TransmittanceSettings& settings, double longest,
                    const Progress& progress, GridFrame& frame) {
    constexpr double of_spacing = 0.8, of_root = 25.6, most = 512;
    frame.reason = VoxelReason::asked;
    if (settings.voxel_size || settings.voxels) {
        frame.voxel_size = settings.voxel_size ? *settings.voxel_size : longest / *settings.voxels;
        return;
    }
    const double spacing = of_spacing * strand_spacing(strands, progress);
    const double finest = longest / std::clamp(of_root * std::sqrt(double(settings.directions)), 32.0, most);
    frame.voxel_size = std::max(spacing, finest);
    frame.reason = spacing > finest ? VoxelReason::spacing : VoxelReason::resolution;
}

}  // namespace

GridFrame make_grid_frame(const StrandGeometry& strands, const TransmittanceSettings& settings,
                          const Progress& progress) {
    HAIRBAKE_ASSERT(strands.vertex_count() > 0);
    if (strands.vertex_count() >> 31)
        throw Error(ErrorKind::out_of_resources, "the hair model has " + std::to_string(strands.vertex_count()) +
                                                     " vertices; the volume method takes fewer than 2147483648");
    if (!settings.voxel_size && settings.voxels && (*settings.voxels < 1 || *settings.voxels > 1024))
        throw Error(ErrorKind::usage,
                    "transmittance.voxels is " + std::to_string(*settings.voxels) + "; allowed are 32 to 1024",
                    "transmittance.voxels");
    const Vec3d side = Vec3d(strands.bounds_max) - Vec3d(strands.bounds_min);
    const double longest = std::max({side.x, side.y, side.z});
    GridFrame frame;
    ask_for_voxels(strands, settings, longest, progress, frame);
    const double asked = frame.voxel_size, least = 2 * typical_largest_width(strands.widths);
    if (least > asked) frame.reason = VoxelReason::width;
    frame.voxel_size = std::max(asked, least);
    if (!(frame.voxel_size > 1e-30 && frame.voxel_size < 1e30))
        throw Error(ErrorKind::bad_input, "the hair model is " + short_number(longest) +
                                              " units large, which makes voxels of " + short_number(frame.voxel_size) +
                                              "; allowed are 1e-30 to 1e30");
    // Half a voxel more than 1,024, for the rounding of the division above.
    if (longest / frame.voxel_size > 1024.5)
        throw Error(ErrorKind::usage,
                    "transmittance.voxel_size is " + short_number(asked) + ", which makes " +
                        short_number(std::ceil(longest / frame.voxel_size)) +
                        " voxels on the longest axis; allowed are at most 1024",
                    "transmittance.voxel_size");
    frame.origin = strands.bounds_min - Vec3f(static_cast<float>(frame.voxel_size));
    for (int axis = 0; axis < 3; ++axis) {
        // One voxel of margin below, one above, and one for the last vertex, which lies on a voxel's upper face.
        const int voxels = static_cast<int>(side[axis] / frame.voxel_size) + 3;
        frame.bricks[static_cast<std::size_t>(axis)] = (voxels + 7) / 8;
    }
    return frame;
}

}  // namespace hairbake
