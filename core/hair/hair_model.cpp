#include "core/hair/hair_model.h"

#include <algorithm>

#include "core/base/assert.h"

namespace hairbake {

std::string place_of_point(const HairModel& model, std::size_t i) {
    HAIRBAKE_ASSERT(i < model.vertex_count());
    const auto& begin = model.strand_begin;
    const auto strand = std::upper_bound(begin.begin(), begin.end(), i) - begin.begin() - 1;
    return "strand " + std::to_string(strand) + ", vertex " + std::to_string(i - begin[strand]);
}

}  // namespace hairbake
