// Sample grooms: seeded straight, wavy and curly hair on the head of head_shape.h.
#pragma once

#include <cstdint>
#include <string>

#include "core/hair/hair_model.h"
#include "core/sample/groom_style.h"

namespace hairbake {

/// Number and style of the strands.
struct GroomSettings {
    GroomStyle style = GroomStyle::straight;
    std::uint64_t vertices = 1'500'000;      ///< exact total, 0 to 1e9; a total of 1 gives one strand of one point
    std::uint32_t vertices_per_strand = 30;  ///< 2 to 65,535; where it does not divide the total, some strands get more
    std::uint64_t seed = 1;
};

/// Settings with the vertex counts of the four models of the published method: 1,519,823 straight, 687,532 wavy,
/// 1,031,268 curly (48 vertices a strand) and 872,756 wavy with longer strands of 40 vertices.
/// Throws Error(usage) unless `number` is 1 to 4.
GroomSettings paper_model(int number);

/// Strands of 10 to 30 cm, root first, in centimetres, Y up, the face towards +Z. Each is about 0.01 cm wide at the
/// root and tapers to 60 % of that (thickness array). The roots lie on the surface of head_shape.h, and no vertex lies
/// inside it. The same settings give the same model for any thread count.
/// Throws Error(usage) naming the field for a value out of range.
HairModel generate_groom(const GroomSettings& settings);

/// One line about the groom, for the free text of its file.
std::string description_of(const GroomSettings& settings);

}  // namespace hairbake
