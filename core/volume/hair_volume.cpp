#include "core/volume/hair_volume.h"

#include "core/base/assert.h"

namespace hairbake {

HairVolume make_hair_volume(const StrandGeometry& strands, const TransmittanceSettings& settings, Progress& progress) {
    HAIRBAKE_ASSERT(strands.vertex_count() > 0);
    HairVolume volume;
    volume.frame = make_grid_frame(strands, settings, progress);
    volume.sorted = sort_strands(strands, volume.frame, progress);
    progress.report(2.0 / 3);
    volume.bricks = deposit_strands(volume.sorted, progress);
    progress.report(1);
    return volume;
}

}  // namespace hairbake
