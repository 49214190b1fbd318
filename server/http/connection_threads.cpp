#include "server/http/connection_threads.h"

#include <spdlog/spdlog.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <thread>

#include "core/base/assert.h"

namespace hairbake {
namespace {

constexpr std::size_t most_accepting = 4;  // a burst of so many connections wakes no thread

using Clock = std::chrono::steady_clock;

/// Whether the socket cannot accept any more.
bool is_final(int error) { return error == EINVAL || error == EBADF || error == ENOTSOCK; }

/// Whether accept() can be called again at once: a signal came, or the client went away. The other errors are shortages
/// of descriptors or memory, which may pass.
bool is_nothing(int error) { return error == EINTR || error == EAGAIN || error == ECONNABORTED; }

/// Whether the client has sent nothing yet.
bool is_silent(int socket) {
    char first = 0;
    return ::recv(socket, &first, 1, MSG_PEEK | MSG_DONTWAIT) < 0 && (errno == EAGAIN || errno == EWOULDBLOCK);
}

}  // namespace

ConnectionThreads::ConnectionThreads(int listening, int threads, int waiting, Server serve, Handler refuse)
    : listening_(listening),
      threads_(static_cast<std::size_t>(threads)),
      most_waiting_(static_cast<std::size_t>(waiting)),
      serve_(std::move(serve)),
      refuse_(std::move(refuse)) {
    HAIRBAKE_ASSERT(threads >= 1 && waiting >= 1);
    idle_.reserve(threads_ + 1);  // no allocation later: a shortage of memory must not end a thread
    waiting_.reserve(most_waiting_);
    running_.reserve(threads_ + 1);
    try {
        for (std::size_t i = 0; i <= threads_; ++i) running_.emplace_back([this] { work(); });
    } catch (const std::system_error& error) {
        stop();  // the members' destructors wait for the threads
        throw std::system_error(error.code(), "the system gives no " + std::to_string(threads_ + 1) +
                                                  " threads for connections (see [listen] threads)");
    }
}

ConnectionThreads::~ConnectionThreads() { stop(); }

void ConnectionThreads::join() {
    for (std::jthread& thread : running_)
        if (thread.joinable()) thread.join();
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
                for (; socket >= 0; socket = next_waiting()) serve_(socket, *this);
                break;
            case Place::at_door:
                refuse_(socket);
                break;
            case Place::elsewhere:  // in the queue, or no connection was accepted
                break;
        }
    }
}

/// Sleeps while enough other threads accept. Returns false when the threads shall end.
bool ConnectionThreads::await_turn(std::condition_variable& woken) {
    std::unique_lock lock(mutex_);
    while (!ending_ && accepting_ == most_accepting) {
        idle_.push_back(&woken);
        woken.wait(lock);
        std::erase(idle_, &woken);  // it is still there after a spurious wake-up
    }
    if (!ending_) ++accepting_;
    return !ending_;
}

/// Returns a socket, or -1 when none was accepted.
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

/// Logs the error, at most once a minute.
void ConnectionThreads::complain(int error) {
    {
        const std::lock_guard lock(mutex_);
        if (Clock::now() < silent_until_) return;
        silent_until_ = Clock::now() + std::chrono::minutes(1);
    }
    spdlog::error("no connection can be accepted at present: {}", std::generic_category().message(error));
}

/// For a full queue. Returns the socket to be refused: that of the first connection that has sent nothing, whose place
/// the new one takes, or else the new one.
int ConnectionThreads::trade_for_silent(int accepted) {
    const auto silent = std::find_if(waiting_.begin(), waiting_.end(), is_silent);
    if (silent == waiting_.end()) return accepted;
    const int refused = *silent;
    waiting_.erase(silent);
    waiting_.push_back(accepted);
    return refused;
}

/// Where an accepted connection goes. At the door, `accepted` becomes the one to be refused.
ConnectionThreads::Place ConnectionThreads::place(int& accepted) {
    const std::lock_guard lock(mutex_);
    --accepting_;
    if (accepted < 0) return Place::elsewhere;
    if (serving_ == threads_) {
        if (waiting_.size() == most_waiting_) {
            accepted = trade_for_silent(accepted);
            return Place::at_door;
        }
        waiting_.push_back(accepted);
        others_wait_ = true;
        return Place::elsewhere;
    }
    ++serving_;
    if (accepting_ == 0 && !idle_.empty()) {
        idle_.back()->notify_one();
        idle_.pop_back();
    }
    return Place::with_thread;
}

/// The next connection for a thread that has served one; -1 when none waits.
int ConnectionThreads::next_waiting() {
    const std::lock_guard lock(mutex_);
    if (waiting_.empty()) {
        --serving_;
        return -1;
    }
    auto next = std::find_if_not(waiting_.begin(), waiting_.end(), is_silent);
    if (next == waiting_.end()) next = waiting_.begin();
    const int socket = *next;
    waiting_.erase(next);
    others_wait_ = !waiting_.empty();
    return socket;
}

}  // namespace hairbake
