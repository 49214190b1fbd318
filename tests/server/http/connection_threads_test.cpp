#include "server/http/connection_threads.h"

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <condition_variable>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace hairbake {
namespace {

/// A listening port of the loopback.
struct Door {
    Door() {
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        auto* const any = reinterpret_cast<sockaddr*>(&address);
        socklen_t size = sizeof address;
        EXPECT_EQ(::bind(listening, any, size), 0);
        EXPECT_EQ(::listen(listening, 64), 0);
        EXPECT_EQ(::getsockname(listening, any, &size), 0);
    }
    ~Door() {
        forget_clients();
        ::close(listening);
    }
    /// Fails instead of waiting for ever for a client that cannot connect.
    void knock() {
        clients.push_back(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
        if (::connect(clients.back(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
            throw std::system_error(errno, std::generic_category(), "a client of the test");
    }
    void forget_clients() {
        for (const int client : clients) ::close(client);
        clients.clear();
    }

    sockaddr_in address{};
    int listening = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    std::vector<int> clients;
};

/// Handlers that record their connections. A serving thread waits until it is released.
struct House {
    void serve(int socket) {
        std::unique_lock lock(mutex);
        ++serving;
        most_serving = std::max(most_serving, serving);
        changed.notify_all();
        changed.wait(lock, [&] { return open; });
        --serving;
        ++served;
        changed.notify_all();
        ::close(socket);
    }
    void refuse(int socket) {
        const std::lock_guard lock(mutex);
        ++refused;
        changed.notify_all();
        ::close(socket);
    }
    /// Waits as long as it takes: CTest ends a test that hangs.
    template <class Condition>
    void await(Condition condition) {
        std::unique_lock lock(mutex);
        changed.wait(lock, condition);
    }
    void let_go() {
        const std::lock_guard lock(mutex);
        open = true;
        changed.notify_all();
    }

    std::mutex mutex;
    std::condition_variable changed;
    int serving = 0, most_serving = 0, served = 0, refused = 0;
    bool open = false;
};

/// ConnectionThreads that run beside the test.
struct Running {
    Running(int count, int waiting)
        : threads(
              door.listening, count, waiting, [this](int socket, const ConnectionThreads&) { house.serve(socket); },
              [this](int socket) { house.refuse(socket); }),
          runner([this] { threads.join(); }) {}
    ~Running() {  // when the test failed
        house.let_go();
        threads.stop();
    }
    void knock(int times) {
        for (int i = 0; i < times; ++i) door.knock();
    }
    void end() {
        threads.stop();
        runner.join();
    }

    Door door;
    House house;
    ConnectionThreads threads;
    std::jthread runner;
};

/// Returns when the threads have ended.
int served_by(int listening, bool stopped) {
    House house;
    ConnectionThreads threads(
        listening, 4, 4, [&](int socket, const ConnectionThreads&) { house.serve(socket); },
        [&](int socket) { house.refuse(socket); });
    if (stopped) threads.stop();
    threads.join();
    return house.served;
}

TEST(ConnectionThreads, ServeSoManyAtOnceHoldSoManyMoreAndRefuseTheRest) {
    Running r(3, 2);
    // 3 are served and 2 wait, so that of 9 the other 4 are refused, whatever the order.
    r.knock(9);
    r.house.await([&] { return r.house.serving == 3 && r.house.refused == 4; });
    r.house.let_go();
    r.house.await([&] { return r.house.served == 5; });
    r.end();
    EXPECT_EQ(r.house.most_serving, 3);
    EXPECT_EQ(r.house.served, 5);
    EXPECT_EQ(r.house.refused, 4);
}

TEST(ConnectionThreads, AllServeAtOnceThoughFewAcceptAtATime) {
    Running r(20, 1);
    r.knock(20);
    r.house.await([&] { return r.house.serving == 20; });
    r.house.let_go();
    r.end();
    EXPECT_EQ(r.house.served, 20);
    EXPECT_EQ(r.house.refused, 0);
}

TEST(ConnectionThreads, ServeThousandsOneAfterAnotherAndLoseNone) {
    Running r(8, 8);
    r.house.let_go();
    for (int total = 8; total <= 2000; total += 8) {
        r.knock(8);  // no more at once than are served, and as many may wait
        r.house.await([&] { return r.house.served == total; });
        r.door.forget_clients();
    }
    r.end();
    EXPECT_EQ(r.house.served, 2000);
    EXPECT_EQ(r.house.refused, 0);
}

TEST(ConnectionThreads, WhatWaitsIsServedAfterTheStop) {
    Running r(1, 3);
    r.knock(5);  // the fifth is refused: then the others are in
    r.house.await([&] { return r.house.serving == 1 && r.house.refused == 1; });
    r.threads.stop();
    r.house.let_go();
    r.runner.join();
    EXPECT_EQ(r.house.served, 4);
}

TEST(ConnectionThreads, EndAtOnceWhenTheyAreStopped) {
    const Door door;
    EXPECT_EQ(served_by(door.listening, true), 0);
}

TEST(ConnectionThreads, EndWhenTheSocketCannotAccept) {
    const int deaf = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);  // does not listen: EINVAL
    EXPECT_EQ(served_by(deaf, false), 0);
    ::close(deaf);
}

}  // namespace
}  // namespace hairbake
