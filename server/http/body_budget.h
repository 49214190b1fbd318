// A budget of memory that requests share: one that needs more than is left waits.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>

namespace hairbake {

/// Thread-safe. Shares are given in the order in which they were asked for, so that a large one is not passed by for
/// ever.
class BodyBudget {
public:
    explicit BodyBudget(std::size_t bytes) : total_(bytes), left_(bytes) {}

    /// A part of the budget, which its destructor gives back. The budget outlives it.
    class Share {
    public:
        Share() = default;
        ~Share();
        Share(Share&& other) noexcept;
        Share& operator=(Share&& other) = delete;

    private:
        friend class BodyBudget;
        Share(BodyBudget& budget, std::size_t bytes) : budget_(&budget), bytes_(bytes) {}

        BodyBudget* budget_ = nullptr;
        std::size_t bytes_ = 0;
    };

    /// Waits until `bytes` are left, or the whole budget when `bytes` are more.
    Share take(std::size_t bytes);

private:
    void give_back(std::size_t bytes);

    const std::size_t total_;
    std::mutex mutex_;  ///< guards the members below
    std::condition_variable changed_;
    std::size_t left_;
    std::uint64_t next_ticket_ = 0, served_ = 0;
};

}  // namespace hairbake
