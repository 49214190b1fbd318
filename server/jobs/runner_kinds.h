// Runners by name.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/jobs/runner.h"

namespace hairbake {

/// The kind that runs workers as child processes of the daemon. Inspections always use it, since a client waits.
inline constexpr const char* local_runner_name = "local";

/// The names that `[workers] runner` may have.
std::vector<std::string> runner_names();

/// Throws Error(usage) for an unknown name.
std::unique_ptr<Runner> make_runner(const std::string& name, const RunnerSettings& settings);

}  // namespace hairbake
