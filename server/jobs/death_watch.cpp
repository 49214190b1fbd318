#include "server/jobs/death_watch.h"

namespace hairbake {

void DeathWatch::started(const std::string& stage) { starts_[stage] = ++tick_; }

/// Whether the last death of another stage shows that the machine is in trouble.
bool DeathWatch::is_sign(const Deaths& deaths, Time now) const {
    return !deaths.others_worked && !deaths.is_own && now - deaths.last <= patience_;
}

DeathWatch::Verdict DeathWatch::died(const std::string& stage, Time now) {
    starts_.erase(stage);
    const bool is_known = deaths_.count(stage) > 0;
    Deaths& own = deaths_[stage];
    own.is_own = is_known && own.others_worked;
    if (own.is_own) own.forgiven_since.reset();
    if (own.is_own || now - own.last > patience_) own.counted = 0;
    own.last = now;
    own.tick = ++tick_;
    own.others_worked = false;
    Verdict verdict;
    if (!own.is_own)
        for (const auto& [other, deaths] : deaths_) verdict.stages += other == stage || is_sign(deaths, now);
    verdict.is_of_machine =
        verdict.stages > 1 && now - own.forgiven_since.value_or(now) <= patience_ && patience_ > Duration::zero();
    if (!verdict.is_of_machine) {
        ++own.counted;
        return verdict;
    }
    if (!own.forgiven_since) own.forgiven_since = now;
    for (auto& [other, deaths] : deaths_) {
        if (deaths.counted == 0 || deaths.forgiven_since || !is_sign(deaths, now)) continue;
        verdict.also.push_back({other, deaths.counted});
        deaths.counted = 0;
        deaths.forgiven_since = now;
    }
    return verdict;
}

void DeathWatch::worked(const std::string& stage) {
    const auto start = starts_.find(stage);
    const std::uint64_t began = start == starts_.end() ? 0 : start->second;
    forget(stage);
    for (auto& [other, deaths] : deaths_) deaths.others_worked = deaths.others_worked || began > deaths.tick;
}

void DeathWatch::forget(const std::string& stage) {
    starts_.erase(stage);
    deaths_.erase(stage);
}

}  // namespace hairbake
