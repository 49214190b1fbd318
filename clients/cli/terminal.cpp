#include "clients/cli/terminal.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <charconv>
#include <cstdlib>
#include <string_view>
#include <system_error>

namespace hairbake {
namespace {

std::string_view variable(const char* name) {
    const char* value = std::getenv(name);
    return value ? value : "";
}

}  // namespace

bool is_terminal() { return isatty(STDERR_FILENO) != 0; }

bool understands_codes() {
    const std::string_view term = variable("TERM");
    return is_terminal() && !term.empty() && term != "dumb";
}

bool without_colors() { return !variable("NO_COLOR").empty() || !understands_codes(); }

int columns() {
    constexpr int usual = 80, most = 10000;
    const std::string_view text = variable("COLUMNS");
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc() && end == text.data() + text.size() && value >= 1 && value <= most) return value;
    winsize size{};
    if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
    return usual;
}

}  // namespace hairbake
