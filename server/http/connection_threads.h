// The threads that accept and serve connections: a fixed number, and a bounded queue.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace hairbake {

/// A thread serves the connections that it accepted itself, so under light load no connection changes its thread. A few
/// threads accept at a time; the others sleep. The thread that fell asleep last is woken first, since its stack is
/// still in the cache. While all `threads` serve, one more thread accepts: connections wait in the queue in order.
/// Those that have sent something go first. When the queue is full, the first that has sent nothing is refused, or else
/// the new one: so idle connections keep no others out.
class ConnectionThreads {
public:
    /// Takes over an accepted connection's socket. Must not throw.
    using Handler = std::function<void(int socket)>;
    /// The same, and may ask `threads` whether others wait.
    using Server = std::function<void(int socket, const ConnectionThreads& threads)>;

    /// Starts all threads, which accept from now on. `listening` is a socket that outlives this object.
    /// `threads` >= 1 connections are served at once.
    /// `waiting` >= 1 connections may be in the queue.
    /// `serve` and `refuse` handle a connection; one thread at a time calls `refuse`.
    /// Throws std::system_error when the system gives no more threads; a connection that was accepted meanwhile is
    /// served.
    ConnectionThreads(int listening, int threads, int waiting, Server serve, Handler refuse);

    /// Stops, and waits as join() does.
    ~ConnectionThreads();
    ConnectionThreads(const ConnectionThreads&) = delete;
    ConnectionThreads& operator=(const ConnectionThreads&) = delete;

    /// Waits until stop() is called or the socket cannot accept any more. Returns when all accepted connections are
    /// served and all threads have ended. Call it from one thread.
    void join();
    /// Thread-safe.
    void stop();
    /// Whether a connection waits because all threads serve. Thread-safe, and takes no lock.
    bool others_wait() const { return others_wait_; }

private:
    enum class Place { with_thread, at_door, elsewhere };

    void work();
    bool await_turn(std::condition_variable& woken);
    int accept();
    void complain(int error);
    Place place(int& accepted);
    int trade_for_silent(int accepted);
    int next_waiting();

    const int listening_;
    const std::size_t threads_, most_waiting_;
    const Server serve_;
    const Handler refuse_;
    std::atomic<bool> others_wait_ = false;  ///< whether waiting_ has some
    std::mutex mutex_;                       ///< guards the members below
    bool ending_ = false;
    std::chrono::steady_clock::time_point silent_until_{};
    std::size_t accepting_ = 0, serving_ = 0;     ///< threads
    std::vector<int> waiting_;                    ///< sockets; none while fewer than `threads` serve
    std::vector<std::condition_variable*> idle_;  ///< of sleeping threads; the last is woken first
    std::vector<std::jthread> running_;           ///< the last member: they use the others
};

}  // namespace hairbake
