// Numbers in messages.
#pragma once

#include <cstdio>
#include <string>

namespace hairbake {

/// At most ten significant digits, no zeros at the end: "0.25", "1e+18", "nan".
inline std::string short_number(double value) {
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, "%.10g", value);
    return buffer;
}

}  // namespace hairbake
