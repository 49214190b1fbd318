#include "server/jobs/worker_trial.h"

#include <chrono>
#include <nlohmann/json.hpp>

#include "core/request/stages.h"
#include "server/store/file_system.h"

namespace hairbake {
namespace {

using End = Outcome::End;
using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds longest_trial{60};

Outcome outcome(End end, const std::string& message) {
    return {end, "{}", ErrorKind::out_of_resources, message, {}, false};
}

/// The worker made other keys than the daemon if it is of another version.
Outcome check_version(const Outcome& trial, const std::string& program) {
    const auto facts = nlohmann::json::parse(trial.facts, nullptr, false);
    const auto found = facts.is_object() ? facts.value("versions", nlohmann::json()) : nlohmann::json();
    if (found == versions_text()) return trial;
    return outcome(End::trouble, "the versions of the worker program " + program + " are " + found.dump() +
                                     "; allowed are those of the daemon, \"" + versions_text() +
                                     "\": start the daemon again");
}

}  // namespace

Outcome run_trial(Runner& runner, const std::filesystem::path& incoming, const std::function<Wish()>& wish) try {
    const WorkFolder folder(incoming, R"({"task": "trial", "threads": 1})");
    const Clock::time_point end = Clock::now() + longest_trial;
    const auto wish_until = [&] { return Clock::now() > end ? Wish::stop : wish(); };
    Outcome trial =
        follow_task(runner, runner.start(folder.path()), folder, wish_until, [](std::string_view, double) {});
    if (trial.end == End::done) return check_version(trial, runner.program());
    if (trial.end == End::cancelled && wish() != Wish::stop)
        return outcome(End::trouble, "it was not done after " + std::to_string(longest_trial.count()) + " seconds");
    return trial;
} catch (const std::exception& error) {
    return outcome(End::trouble, error_text(error));
}

Outcome explain_death(Outcome death, Runner& runner, const std::filesystem::path& incoming,
                      const std::function<Wish()>& wish) {
    if (wish() == Wish::stop) return outcome(End::cancelled, {});
    const Outcome trial = run_trial(runner, incoming, wish);
    if (trial.end == End::done) return death;
    if (trial.end == End::cancelled) return trial;
    return outcome(End::trouble, death.message + "; a trial without an input failed, too: " + trial.message);
}

}  // namespace hairbake
