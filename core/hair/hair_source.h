// Shared by the readers of groom files: bytes at an offset, refusals, checks of numbers. Private to the readers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/base/assert.h"
#include "core/hair/hair_model.h"

namespace hairbake {

/// Throws Error(bad_input): "<name>: <what>".
[[noreturn]] void refuse_hair(const std::string& name, const std::string& what);

/// The bytes of a groom file. `copy(offset, to, n)` copies n bytes from `offset`.
/// Throws Error(bad_input) when there are fewer.
struct HairSource {
    std::string name;  ///< for messages
    std::uint64_t size = 0;
    std::function<void(std::uint64_t offset, void* to, std::size_t n)> copy;

    /// `count` values from `offset` on. The caller has checked that the file holds them.
    template <class T>
    std::vector<T> array(std::uint64_t offset, std::size_t count) const {
        HAIRBAKE_ASSERT(offset <= size && count <= (size - offset) / sizeof(T));
        std::vector<T> values(count);
        if (count > 0) copy(offset, values.data(), count * sizeof(T));
        return values;
    }
};

/// `name` stands for the file in messages. A default value is in use where the model has no array.
/// Throws Error(bad_input) naming strand and vertex unless every value in use is finite and every coordinate is at most
/// 1e18 in magnitude.
void check_numbers(const std::string& name, const HairModel& model);

}  // namespace hairbake
