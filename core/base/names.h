// Names of an enum's values: one table for each enum, read in both directions.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/assert.h"

namespace hairbake {

template <class Enum>
struct EnumName {
    Enum value;
    std::string_view name;
};
template <class Enum>
EnumName(Enum, const char*) -> EnumName<Enum>;  // clang 14, of the fuzz targets, cannot deduce it from an aggregate

/// The name of `value`, which must be in the table.
template <class Enum, std::size_t count>
constexpr std::string_view name_in(const std::array<EnumName<Enum>, count>& table, Enum value) {
    for (const EnumName<Enum>& entry : table)
        if (entry.value == value) return entry.name;
    HAIRBAKE_ASSERT(!"the enum's table lacks a value");
    return {};
}

/// The value of that name; empty where the table has no such name.
template <class Enum, std::size_t count>
constexpr std::optional<Enum> find_in(const std::array<EnumName<Enum>, count>& table, std::string_view name) {
    for (const EnumName<Enum>& entry : table)
        if (entry.name == name) return entry.value;
    return std::nullopt;
}

/// "a, b, c", for messages.
template <class Enum, std::size_t count>
std::string list_names(const std::array<EnumName<Enum>, count>& table) {
    std::string list;
    for (const EnumName<Enum>& entry : table) list += (list.empty() ? "" : ", ") + std::string(entry.name);
    return list;
}

}  // namespace hairbake
