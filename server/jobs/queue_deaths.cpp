// What the death of a worker means for its stage: it waits longer after each, fails after too many, or the machine is
// at fault.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "server/jobs/queue.h"
#include "server/store/blob_store.h"
#include "server/store/database.h"

namespace hairbake {
namespace {

using Clock = std::chrono::steady_clock;

QueuePause::Time after(double seconds) {
    return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

std::vector<StageDeath> deaths_of(Sql& sql, const std::string& stage) {
    const auto rows = sql.rows("SELECT deaths FROM stages WHERE key = ?", {stage});
    return rows.empty() ? std::vector<StageDeath>() : read_deaths(rows[0].text(0));
}

void store_deaths(Sql& sql, const std::string& stage, const std::vector<StageDeath>& deaths) {
    sql.run("UPDATE stages SET crashes = ?, deaths = ? WHERE key = ?",
            {static_cast<std::int64_t>(deaths.size()), deaths_json(deaths), stage});
}

}  // namespace

/// Returns all deaths of the stage that count.
std::vector<StageDeath> Queue::add_death(Sql& sql, const std::string& stage, const StageDeath& death) {
    std::vector<StageDeath> deaths = deaths_of(sql, stage);
    deaths.push_back(death);
    store_deaths(sql, stage, deaths);
    return deaths;
}

void Queue::died(const ClaimedStage& stage, const std::string& how, bool from_outside) {
    std::vector<StageDeath> deaths;
    bool has_failed = false;
    database_.write([&](Sql& sql) {
        deaths = add_death(sql, stage.key, {now(), how, from_outside});
        has_failed = deaths.size() > static_cast<std::size_t>(rules_.most);
        if (has_failed)
            fail_stage(sql, stage.key, {ErrorKind::internal, words_for_failure(deaths, rules_), {}});
        else
            release_stage(sql, stage.key);
    });
    const double wait = wait_after_deaths(rules_, deaths.size(), from_outside);
    {
        const std::lock_guard lock(mutex_);
        if (!from_outside) pause_.worked(stage.key);  // a trial worked, so the machine does
        if (!from_outside || has_failed) watch_.forget(stage.key);
        pause_.died(stage.key, words_for_wait(deaths, wait), Clock::now(), after(wait));
        if (has_failed) pause_.forget(stage.key);
    }
    finish_claim(stage);
}

std::optional<std::string> Queue::trouble_in_death(const ClaimedStage& stage, const std::string& how) {
    DeathWatch::Verdict verdict;
    {
        const std::lock_guard lock(mutex_);
        verdict = watch_.died(stage.key, Clock::now());
    }
    if (!verdict.is_of_machine) return std::nullopt;
    forgive(verdict.also);
    return how + "; so were workers of " + std::to_string(verdict.stages) +
           " different stages in the last time, and none has worked since: the machine is short of memory, or another "
           "program ends the workers. Look at the machine's memory and its log";
}

/// Takes the last deaths back. A database that cannot be written leaves them.
void Queue::forgive(const std::vector<DeathWatch::Forgiven>& stages) try {
    if (stages.empty()) return;
    database_.write([&](Sql& sql) {
        for (const auto& [stage, count] : stages) {
            std::vector<StageDeath> deaths = deaths_of(sql, stage);
            deaths.resize(deaths.size() - std::min(deaths.size(), static_cast<std::size_t>(count)));
            store_deaths(sql, stage, deaths);
        }
    });
    const std::lock_guard lock(mutex_);
    for (const auto& [stage, count] : stages) pause_.forget(stage);
} catch (const std::exception& error) {
    spdlog::warn("the deaths of workers by the machine's fault still count: {}", error.what());
}

/// The waits of an earlier daemon go on.
void Queue::hold_after_deaths(Sql& sql) {
    for (const SqlRow& row : sql.rows("SELECT key, deaths FROM stages WHERE state = 'queued' AND crashes > 0")) {
        const std::vector<StageDeath> deaths = read_deaths(row.text(1));
        if (deaths.empty()) continue;
        const double wait = wait_after_deaths(rules_, deaths.size(), deaths.back().from_outside);
        const double left = std::clamp(deaths.back().time + wait - now(), 0.0, wait);
        const std::lock_guard lock(mutex_);
        if (left > 0) pause_.hold(row.text(0), words_for_wait(deaths, wait), after(left));
    }
}

/// Daemons ended while the stage ran: it may be what ends them, and then others must have their turn.
void Queue::hold_after_ends(const std::string& stage, int ends) {
    if (ends < 2 || rules_.first_wait_s == 0) return;
    const double wait = wait_after_deaths(rules_, static_cast<std::size_t>(ends) - 1, true);
    const std::lock_guard lock(mutex_);
    pause_.hold(stage,
                "the daemon was ended while the stage ran; that happened " + std::to_string(ends) +
                    " times, so it starts again after a wait of " + std::to_string(std::lround(wait)) + " s",
                after(wait));
}

}  // namespace hairbake
