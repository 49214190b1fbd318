#include "server/http/connection_threads.h"

#include <spdlog/spdlog.h>
#include <sys/socket.h>

#include <cerrno>
#include <system_error>
#include <thread>

namespace hairbake {
namespace {

constexpr std::size_t most_accepting = 4;  // so many connections come at once without a thread to be woken

using Clock = std::chrono::steady_clock;

/// Whether accept() cannot work any more.
bool is_final(int error) { return error == EINVAL || error == EBADF || error == ENOTSOCK; }

/// Whether the next accept() can work: a signal came, or the client went away. The rest is a shortage of descriptors or
/// memory, which may pass.
bool is_nothing(int error) { return error == EINTR || error == EAGAIN || error == ECONNABORTED; }

}  // namespace

ConnectionThreads::ConnectionThreads(int listening, int threads, int waiting, Handler serve, Handler refuse)
    : listening_(listening),
      threads_(static_cast<std::size_t>(threads)),
      most_waiting_(static_cast<std::size_t>(waiting)),
      serve_(std::move(serve)),
      refuse_(std::move(refuse)) {
    idle_.reserve(threads_ + 1);  // all memory is taken here: what runs out later ends no thread
    waiting_.reserve(most_waiting_);
}

void ConnectionThreads::run() {
    std::vector<std::jthread> others;
    try {
        for (std::size_t i = 0; i < threads_; ++i) others.emplace_back([this] { work(); });
    } catch (...) {
        stop();
        throw;
    }
    work();
}

void ConnectionThreads::stop() {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    ::shutdown(listening_, SHUT_RDWR);  // ends every accept()
    for (std::condition_variable* sleeper : idle_) sleeper->notify_one();
}

void ConnectionThreads::work() {
    std::condition_variable woken;
    while (await_turn(woken)) {
        int socket = accept();
        switch (place(socket)) {
            case Place::with_thread:
                for (; socket >= 0; socket = next_waiting()) serve_(socket);
                break;
            case Place::at_door:
                refuse_(socket);
                break;
            case Place::elsewhere:  // in the queue, or there is none
                break;
        }
    }
}

/// Sleeps while enough others accept. False at the end.
bool ConnectionThreads::await_turn(std::condition_variable& woken) {
    std::unique_lock lock(mutex_);
    while (!ending_ && accepting_ == most_accepting) {
        idle_.push_back(&woken);
        woken.wait(lock);
        std::erase(idle_, &woken);  // still there when it woke by itself
    }
    if (!ending_) ++accepting_;
    return !ending_;
}

/// A socket, or -1 when something came between.
int ConnectionThreads::accept() {
    const int socket = ::accept4(listening_, nullptr, nullptr, SOCK_CLOEXEC);
    if (socket >= 0) return socket;
    const int error = errno;
    if (is_final(error)) {
        stop();
    } else if (!is_nothing(error)) {
        complain(error);
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return -1;
}

/// Once a minute.
void ConnectionThreads::complain(int error) {
    {
        const std::lock_guard lock(mutex_);
        if (Clock::now() < silent_until_) return;
        silent_until_ = Clock::now() + std::chrono::minutes(1);
    }
    spdlog::error("no connection can be accepted for now: {}", std::generic_category().message(error));
}

ConnectionThreads::Place ConnectionThreads::place(int accepted) {
    const std::lock_guard lock(mutex_);
    --accepting_;
    if (accepted < 0) return Place::elsewhere;
    if (serving_ == threads_) {
        if (waiting_.size() == most_waiting_) return Place::at_door;
        waiting_.push_back(accepted);
        return Place::elsewhere;
    }
    ++serving_;
    if (accepting_ == 0 && !idle_.empty()) {
        idle_.back()->notify_one();
        idle_.pop_back();
    }
    return Place::with_thread;
}

/// For a thread that has served one; -1 when none waits.
int ConnectionThreads::next_waiting() {
    const std::lock_guard lock(mutex_);
    if (waiting_.empty()) {
        --serving_;
        return -1;
    }
    const int socket = waiting_.front();
    waiting_.erase(waiting_.begin());
    return socket;
}

}  // namespace hairbake
