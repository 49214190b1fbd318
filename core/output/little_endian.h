// Numbers as the bytes of a binary file.
#pragma once

#include <bit>
#include <concepts>
#include <string>

namespace hairbake {

// Arrays are written as they lie in memory.
static_assert(std::endian::native == std::endian::little, "all our binary files are little-endian");

/// Appends `values` to `bytes`, each in its own size.
template <std::integral... T>
void append_integers(std::string& bytes, T... values) {
    (bytes.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
}

/// Appends zeros up to a multiple of `alignment`.
inline void pad(std::string& bytes, std::size_t alignment) {
    bytes.resize((bytes.size() + alignment - 1) / alignment * alignment);
}

}  // namespace hairbake
