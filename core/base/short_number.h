// Numbers in messages.
#pragma once

#include <cmath>
#include <cstdio>
#include <string>

namespace hairbake {

/// At most ten significant digits, no zeros at the end: "0.25", "1e+18", "nan". Integers that a double holds exactly
/// have all their digits: "9007199254740991".
inline std::string short_number(double value) {
    char buffer[32];
    if (std::abs(value) <= 0x1p53 && value == std::floor(value)) {
        std::snprintf(buffer, sizeof buffer, "%.0f", value + 0.0);  // + 0.0: no sign of a negative zero
        return buffer;
    }
    std::snprintf(buffer, sizeof buffer, "%.10g", value);
    return buffer;
}

}  // namespace hairbake
