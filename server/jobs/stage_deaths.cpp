#include "server/jobs/stage_deaths.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

namespace hairbake {
namespace {

using Json = nlohmann::ordered_json;
constexpr double longest_of_first = 300;  // the longest wait, in first waits: 10 minutes by default
constexpr double growth_outside = 4, growth_inside = 2;

std::string times(std::size_t count) { return count == 1 ? "once" : std::to_string(count) + " times"; }

std::string seconds(double s) { return std::to_string(std::lround(s)) + " s"; }

/// "5 times: the worker was ended by a signal: Killed (SIGKILL); once: ..."
std::string counted_by_kind(const std::vector<StageDeath>& deaths) {
    std::map<std::string, std::size_t> counts;
    for (const StageDeath& death : deaths) ++counts[death.how];
    std::string text;
    for (const auto& [how, count] : counts) text += (text.empty() ? "" : "; ") + times(count) + ": " + how;
    return text;
}

}  // namespace

double longest_wait(const DeathRules& rules) { return longest_of_first * rules.first_wait_s; }

double wait_after_deaths(const DeathRules& rules, std::size_t count, bool from_outside) {
    const double growth = from_outside ? growth_outside : growth_inside;
    const double steps = static_cast<double>(std::min<std::size_t>(count, 20)) - 1;
    return std::min(longest_wait(rules), rules.first_wait_s * std::pow(growth, steps));
}

std::vector<StageDeath> read_deaths(const std::string& json) {
    std::vector<StageDeath> deaths;
    const Json list = Json::parse(json, nullptr, false);
    if (!list.is_array()) return deaths;
    for (const Json& one : list)
        deaths.push_back({one.value("time", 0.0), one.value("how", std::string()), one.value("from_outside", false)});
    return deaths;
}

std::string deaths_json(const std::vector<StageDeath>& deaths) {
    Json list = Json::array();
    for (const StageDeath& death : deaths)
        list.push_back({{"time", death.time}, {"how", death.how}, {"from_outside", death.from_outside}});
    return list.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string words_for_wait(const std::vector<StageDeath>& deaths, double wait_s) {
    return deaths.back().how + "; workers of this stage died " + times(deaths.size()) +
           ", and the next one starts after a wait of " + seconds(wait_s);
}

std::string words_for_failure(const std::vector<StageDeath>& deaths, const DeathRules& rules) {
    const bool is_outside =
        std::any_of(deaths.begin(), deaths.end(), [](const StageDeath& d) { return d.from_outside; });
    const std::string within =
        deaths.size() > 1 ? " within " + seconds(deaths.back().time - deaths.front().time) : std::string();
    return "workers of this stage died " + times(deaths.size()) + within + " (" + counted_by_kind(deaths) +
           "); allowed are " + std::to_string(rules.most) + " deaths ([workers] max_crashes). " +
           (is_outside ? "The system ends processes with SIGKILL when memory is short: look at the machine's memory "
                         "and its log, then submit the request again"
                       : "A trial without the input worked, so the input or the request is probably at fault: check "
                         "them, then submit the request again");
}

}  // namespace hairbake
