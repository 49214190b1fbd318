#include "server/http/place_times.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hairbake {
namespace {

constexpr double weight_of_last = 1.0 / 8;

double seconds_between(PlaceTimes::Clock::time_point begin, PlaceTimes::Clock::time_point end) {
    return std::chrono::duration<double>(end - begin).count();
}

}  // namespace

PlaceTimes::Begun::~Begun() {
    if (times_) times_->end(number_, Clock::now());
}

PlaceTimes::Begun::Begun(Begun&& other) noexcept
    : times_(std::exchange(other.times_, nullptr)), number_(other.number_) {}

PlaceTimes::Begun PlaceTimes::begin(const std::string& address, Clock::time_point now) {
    const std::lock_guard lock(mutex_);
    const std::uint64_t number = next_number_++;
    bodies_[number] = {address, now};
    return {*this, number};
}

void PlaceTimes::end(std::uint64_t number, Clock::time_point now) {
    const std::lock_guard lock(mutex_);
    const auto body = bodies_.find(number);
    if (body == bodies_.end()) return;
    const double taken = seconds_between(body->second.begin, now);
    usual_s_ += (taken - usual_s_) * (has_usual_ ? weight_of_last : 1);
    has_usual_ = true;
    bodies_.erase(body);
}

int PlaceTimes::seconds_until_one_ends(const std::string& address, Clock::time_point now) {
    const std::lock_guard lock(mutex_);
    const auto is_own = [&](const auto& entry) { return entry.second.address == address; };
    const auto own = std::count_if(bodies_.begin(), bodies_.end(), is_own);
    double count = 0, ages = 0;
    for (const auto& entry : bodies_) {
        if (own > 0 && !is_own(entry)) continue;
        ++count;
        ages += seconds_between(entry.second.begin, now);
    }
    if (count == 0) return 1;
    const double taken = std::max(usual_s_, ages / count);
    return static_cast<int>(std::clamp(std::ceil(taken / (count + 1)), 1.0, double(longest_s)));
}

}  // namespace hairbake
