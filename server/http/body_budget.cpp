#include "server/http/body_budget.h"

#include <algorithm>
#include <utility>

namespace hairbake {

BodyBudget::Share::~Share() {
    if (budget_) budget_->give_back(bytes_);
}

BodyBudget::Share::Share(Share&& other) noexcept
    : budget_(std::exchange(other.budget_, nullptr)), bytes_(other.bytes_) {}

BodyBudget::Share BodyBudget::take(std::size_t bytes) {
    const std::size_t needed = std::min(bytes, total_);
    std::unique_lock lock(mutex_);
    const std::uint64_t ticket = next_ticket_++;
    changed_.wait(lock, [&] { return served_ == ticket && left_ >= needed; });
    ++served_;
    left_ -= needed;
    lock.unlock();
    changed_.notify_all();  // the next ticket may fit too
    return {*this, needed};
}

void BodyBudget::give_back(std::size_t bytes) {
    {
        const std::lock_guard lock(mutex_);
        left_ += bytes;
    }
    changed_.notify_all();
}

}  // namespace hairbake
