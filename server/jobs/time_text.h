// Times as replies show them.
#pragma once

#include <string>

namespace hairbake {

/// Seconds since 1970 as RFC 3339 with milliseconds, UTC.
std::string time_text(double seconds);

}  // namespace hairbake
