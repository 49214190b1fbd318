// The occluder's shadow on the hair's vertices, in the order in which a sweep reads them.
#pragma once

#include <optional>
#include <vector>

#include "core/base/progress.h"
#include "core/hair/strand_geometry.h"
#include "core/volume/occluder_shadow.h"
#include "core/volume/slice_layout.h"
#include "core/volume/strand_pieces.h"

namespace hairbake {

/// Refers to `strands`, which must outlive it. Immutable after construction; may be asked from several threads.
class HairShadow {
public:
    /// Throws Error(cancelled).
    HairShadow(const StrandGeometry& strands, const TriangleMesh& occluder, Progress& progress);

    const OccluderShadow& occluder() const { return occluder_; }
    /// The slots of `layout`, padding included.
    OccluderShadow::Points points(const SliceLayout& layout, const SortedStrands& sorted) const;

private:
    const StrandGeometry& strands_;
    std::vector<GroundedPoint> grounded_;  ///< ascending
    OccluderShadow occluder_;
};

}  // namespace hairbake
