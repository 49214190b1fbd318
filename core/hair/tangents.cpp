#include "core/hair/tangents.h"

#include "core/base/parallel.h"

namespace hairbake {
namespace {

/// Sets the tangents of the points [begin, end), one strand. Consecutive points at one place share a tangent.
void tangents_of_strand(const std::vector<Vec3f>& positions, std::size_t begin, std::size_t end,
                        std::vector<Vec3f>& tangents) {
    for (std::size_t run = begin, next; run < end; run = next) {
        for (next = run + 1; next < end && positions[next] == positions[run];) ++next;
        const Vec3d here(positions[run]);
        const Vec3d before = run > begin ? Vec3d(positions[run - 1]) : here;
        const Vec3d after = next < end ? Vec3d(positions[next]) : here;
        Vec3d chord = after - before;
        if (chord == Vec3d()) chord = after - here;
        const Vec3f tangent = chord == Vec3d() ? Vec3f() : Vec3f(normalized(chord));
        for (std::size_t i = run; i < next; ++i) tangents[i] = tangent;
    }
}

}  // namespace

std::vector<Vec3f> vertex_tangents(const HairModel& model) {
    std::vector<Vec3f> tangents(model.vertex_count());
    parallel_for(model.strand_count(), 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t s = begin; s < end; ++s)
            tangents_of_strand(model.positions, model.strand_begin[s], model.strand_begin[s + 1], tangents);
    });
    return tangents;
}

}  // namespace hairbake
