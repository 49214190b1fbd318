#include "server/jobs/runner_kinds.h"

#include <algorithm>
#include <array>

#include "core/base/error.h"

namespace hairbake {

// Each is defined in the source file of its runner.
std::unique_ptr<Runner> make_local_runner(const RunnerSettings& settings);

namespace {

struct RunnerKind {
    const char* name;
    std::unique_ptr<Runner> (*make)(const RunnerSettings& settings);
};

constexpr std::array runner_kinds{RunnerKind{local_runner_name, make_local_runner}};

}  // namespace

std::vector<std::string> runner_names() {
    std::vector<std::string> names;
    for (const RunnerKind& kind : runner_kinds) names.emplace_back(kind.name);
    return names;
}

std::unique_ptr<Runner> make_runner(const std::string& name, const RunnerSettings& settings) {
    const auto kind = std::find_if(runner_kinds.begin(), runner_kinds.end(),
                                   [&](const RunnerKind& candidate) { return name == candidate.name; });
    if (kind == runner_kinds.end()) throw Error(ErrorKind::usage, "there is no runner " + name, "workers.runner");
    return kind->make(settings);
}

}  // namespace hairbake
