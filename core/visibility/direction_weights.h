// Weights by direction that differ from point to point.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace hairbake {

/// Point i gets, for each component c, the sum over the directions k of T_k(i) * values[(rows[i] * directions + k) *
/// components + c]. Many points share a row: a row belongs to a cell of tangents. Refers to its parts.
struct DirectionWeights {
    std::size_t components = 0;  ///< numbers of a point, 1 to most_components
    std::size_t directions = 0;
    std::span<const float> values;        ///< [rows][directions][components]
    std::span<const std::uint32_t> rows;  ///< [P], the row of each point, in the model's order

    static constexpr std::size_t most_components = 8;

    const float* of(std::uint32_t row, std::size_t direction) const {
        return values.data() + (std::size_t{row} * directions + direction) * components;
    }
};

}  // namespace hairbake
