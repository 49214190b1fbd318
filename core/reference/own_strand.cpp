#include "core/reference/own_strand.h"

#include <algorithm>

#include "core/base/assert.h"

namespace hairbake {
namespace {

/// A ray that runs along its strand from joint to joint.
class JointWalk {
public:
    JointWalk(const StrandGeometry& strands, std::uint32_t v, const Vec3f& l)
        : strands_(strands), origin_(strands.positions[v]), direction_(l) {}

    /// Whether the ray passes `joint` inside the strand, and not before the previous joint. A step back of up to a
    /// radius is no turn: joints much closer than the strand is wide are not in line.
    bool passes(std::uint32_t joint) {
        const Vec3d to_joint = Vec3d(strands_.positions[joint]) - origin_;
        const double t = std::max(0.0, dot(to_joint, direction_));
        if (t < passed_ - 0.5 * double(strands_.widths[joint])) return false;
        passed_ = std::max(passed_, t);
        constexpr double rounding = 1.0001;  // of Embree and of this function
        return length(to_joint - t * direction_) <= 0.5 * rounding * double(strands_.widths[joint]);
    }

private:
    const StrandGeometry& strands_;
    Vec3d origin_, direction_;
    double passed_ = 0;
};

}  // namespace

bool enters_from_inside(const StrandGeometry& strands, std::uint32_t v, const OwnSegments& own, std::uint32_t segment,
                        const Vec3f& l) {
    HAIRBAKE_ASSERT(!own.contains(segment));
    JointWalk walk(strands, v, l);
    if (segment > own.last) {
        for (std::uint32_t joint = own.last + 1; joint <= segment; ++joint)
            if (strands.segments[joint - 1] == Segment::none || !walk.passes(joint)) return false;
        return true;
    }
    for (std::uint32_t joint = own.first; joint > segment; --joint)
        if (strands.segments[joint - 1] == Segment::none || !walk.passes(joint)) return false;
    return true;
}

}  // namespace hairbake
