#include "server/jobs/time_text.h"

#include <cmath>
#include <cstdio>
#include <ctime>

namespace hairbake {

std::string time_text(double seconds) {
    const auto whole = static_cast<std::time_t>(std::floor(seconds));
    std::tm parts{};
    ::gmtime_r(&whole, &parts);
    char date[32], text[40];
    std::strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%S", &parts);
    std::snprintf(text, sizeof text, "%s.%03dZ", date, static_cast<int>((seconds - static_cast<double>(whole)) * 1000));
    return text;
}

}  // namespace hairbake
