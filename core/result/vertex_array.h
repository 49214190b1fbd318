// Named arrays of a result: a row of numbers for each vertex of the hair, or for each position of the receiver.
//
// Writers, reader, manifest, comparison and preview loop over arrays. Only the table in vertex_array.cpp knows names.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/request/request.h"

namespace hairbake {

enum class ArrayOwner {
    hair,     ///< a row for each vertex, in the hair file's order
    receiver  ///< a row for each position of the receiver mesh, in its file's order
};

enum class ArrayLayout {
    scalar,       ///< one number a row: shape [V]
    vector,       ///< a vector a row: shape [V, n], one attribute of n components
    coefficients  ///< independent numbers: shape [V, n], n attributes of one component, numbered from 0
};

/// The meaning of an array.
struct ArrayKind {
    std::string_view name;     ///< of the array and of its file NAME.npy
    std::string_view meaning;  ///< one line for people
    std::string_view stage;    ///< that makes it
    ArrayOwner owner;
    ArrayLayout layout;
    std::size_t (*components)(const BakeRequest&);  ///< a row; 0 where the request does not ask for the array
    bool is_share;                                  ///< every number is in [0, 1]
};

/// All kinds, in the order in which a result lists them.
std::span<const ArrayKind> array_kinds();

/// Null where there is no kind of this name.
const ArrayKind* find_array_kind(std::string_view name);

/// The kinds that other code asks for by their meaning: A, T(x, l) as spherical harmonics, the bent cone, and the
/// shadow on the receiver.
const ArrayKind& average_transmittance_kind();
const ArrayKind& effective_transmittance_kind();
const ArrayKind& transmittance_sh_kind();
const ArrayKind& bent_cone_kind();
const ArrayKind& receiver_kind();

/// An array and its numbers: values[row * components + component].
struct VertexArray {
    const ArrayKind* kind = nullptr;
    std::size_t components = 1;
    std::vector<float> values;

    std::size_t rows() const { return values.size() / components; }
    /// [rows] of a scalar, [rows, components] of the others.
    std::vector<std::size_t> shape() const;
};

/// The array of this kind, or null.
const VertexArray* find_array(std::span<const VertexArray> arrays, const ArrayKind& kind);

/// Moves the numbers of this kind's array out; empty where there is none.
std::vector<float> take_values(std::vector<VertexArray>& arrays, const ArrayKind& kind);

}  // namespace hairbake
