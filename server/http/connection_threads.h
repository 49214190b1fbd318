// The threads that accept connections and answer them: a fixed number, and a queue that does not grow without end.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <vector>

namespace hairbake {

/// A thread serves the connection that it accepted itself, so that none is handed from one thread to another while few
/// come. A few threads accept at a time and the others sleep; of those, who fell asleep last is woken first: its stack
/// and its memory are still in the cache. When all `threads` serve, one more accepts: what it accepts waits in the
/// order in which it came, and what finds the queue full is refused.
class ConnectionThreads {
public:
    /// Gets an accepted connection's socket, which it closes. Must not throw.
    using Handler = std::function<void(int socket)>;

    /// listening: a socket that outlives this. threads: how many connections are served at once; waiting: how many
    /// more are held; both at least 1. `refuse` is called by one thread at a time.
    ConnectionThreads(int listening, int threads, int waiting, Handler serve, Handler refuse);

    /// Accepts until stop(), or until the socket cannot accept any more; then returns when all that was accepted has
    /// been served and every thread has ended. To be called once.
    void run();
    /// Thread-safe; before run() too.
    void stop();

private:
    enum class Place { with_thread, at_door, elsewhere };

    void work();
    bool await_turn(std::condition_variable& woken);
    int accept();
    void complain(int error);
    Place place(int accepted);
    int next_waiting();

    const int listening_;
    const std::size_t threads_, most_waiting_;
    const Handler serve_, refuse_;
    std::mutex mutex_;  ///< of what follows
    bool ending_ = false;
    std::chrono::steady_clock::time_point silent_until_{};
    std::size_t accepting_ = 0, serving_ = 0;     ///< threads
    std::vector<int> waiting_;                    ///< sockets; none while fewer than `threads` serve
    std::vector<std::condition_variable*> idle_;  ///< of sleeping threads; the last is woken first
};

}  // namespace hairbake
