#include "clients/cli/messages.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "clients/cli/terminal.h"

namespace hairbake {
namespace {

spdlog::logger& logger() {
    static const auto log = [] {
        auto made = spdlog::stderr_color_mt(
            "hairbake", without_colors() ? spdlog::color_mode::never : spdlog::color_mode::automatic);
        made->set_pattern("%n: %^%l%$: %v");
        return made;
    }();
    return *log;
}

}  // namespace

void say_note(const std::string& text) { logger().info("{}", text); }
void say_warning(const std::string& text) { logger().warn("{}", text); }
void say_warnings(const std::vector<std::string>& texts) {
    for (const std::string& text : texts) say_warning(text);
}
void say_error(const std::string& text) { logger().error("{}", text); }

}  // namespace hairbake
