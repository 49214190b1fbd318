// Deaths of the workers of one stage: how long the stage waits after each, and the words about them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace hairbake {

/// The [workers] settings about deaths.
struct DeathRules {
    int most = 5;             ///< deaths of a stage's workers; after one more the stage fails
    double first_wait_s = 2;  ///< after the first death; 0: no waits, and each death counts
};

/// One worker that died after it had begun its task, while a trial worked (worker_trial.h).
struct StageDeath {
    double time = 0;            ///< seconds since 1970
    std::string how;            ///< for people: "the worker was ended by a signal: Killed (SIGKILL)"
    bool from_outside = false;  ///< the system or another process ended it, and no fault of its own
};

/// The longest wait, in seconds. Deaths that lie further apart tell nothing about each other.
double longest_wait(const DeathRules& rules);

/// Seconds from the last of `count` deaths, at least 1, to the next try. A wait is 4 times the one before when the
/// last death came from outside, and else 2 times: what the worker does by itself it usually does again at once.
double wait_after_deaths(const DeathRules& rules, std::size_t count, bool from_outside);

/// As the column `deaths` of a stage has them; an empty text is no deaths.
std::vector<StageDeath> read_deaths(const std::string& json);
std::string deaths_json(const std::vector<StageDeath>& deaths);

/// Why a stage waits after these deaths, of which there is one at least.
std::string words_for_wait(const std::vector<StageDeath>& deaths, double wait_s);

/// Why a stage failed by these deaths: how often, how, within which time, and what to do.
std::string words_for_failure(const std::vector<StageDeath>& deaths, const DeathRules& rules);

}  // namespace hairbake
