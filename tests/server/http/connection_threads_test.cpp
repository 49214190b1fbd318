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

/// A port of the loopback that is listened on.
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
    /// A client that does not get in would be waited for without end.
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

/// Handlers that note what they get; who serves waits until it is let go.
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

/// Threads that run beside the test.
struct Running {
    Running(Door& door, House& house, int count, int waiting)
        : threads(
              door.listening, count, waiting, [&house](int socket) { house.serve(socket); },
              [&house](int socket) { house.refuse(socket); }),
          runner([this] { threads.run(); }) {}

    ConnectionThreads threads;
    std::jthread runner;
};

TEST(ConnectionThreads, ServeSoManyAtOnceHoldSoManyMoreAndRefuseTheRest) {
    Door door;
    House house;
    Running running(door, house, 3, 2);
    // 3 are served and 2 wait, so that of 9 the other 4 are refused, whatever the order.
    for (int i = 0; i < 9; ++i) door.knock();
    house.await([&] { return house.serving == 3 && house.refused == 4; });
    house.let_go();
    house.await([&] { return house.served == 5; });
    running.threads.stop();
    running.runner.join();
    EXPECT_EQ(house.most_serving, 3);
    EXPECT_EQ(house.served, 5);
    EXPECT_EQ(house.refused, 4);
}

TEST(ConnectionThreads, AllServeAtOnceThoughFewAcceptAtATime) {
    Door door;
    House house;
    Running running(door, house, 20, 1);
    for (int i = 0; i < 20; ++i) door.knock();
    house.await([&] { return house.serving == 20; });
    house.let_go();
    running.threads.stop();
    running.runner.join();
    EXPECT_EQ(house.served, 20);
    EXPECT_EQ(house.refused, 0);
}

TEST(ConnectionThreads, ServeThousandsOneAfterAnotherAndLoseNone) {
    Door door;
    House house;
    house.let_go();
    Running running(door, house, 8, 8);
    for (int i = 1; i <= 2000; ++i) {
        door.knock();
        if (i % 8 != 0) continue;  // no more at once than are served, and as many may wait
        house.await([&] { return house.served == i; });
        door.forget_clients();
    }
    running.threads.stop();
    running.runner.join();
    EXPECT_EQ(house.served, 2000);
    EXPECT_EQ(house.refused, 0);
}

TEST(ConnectionThreads, WhatWaitsIsServedAfterTheStop) {
    Door door;
    House house;
    Running running(door, house, 1, 3);
    for (int i = 0; i < 5; ++i) door.knock();  // the fifth is refused: then the others are in
    house.await([&] { return house.serving == 1 && house.refused == 1; });
    running.threads.stop();
    house.let_go();
    running.runner.join();
    EXPECT_EQ(house.served, 4);
}

TEST(ConnectionThreads, EndAtOnceWhenTheyWereStoppedBefore) {
    Door door;
    House house;
    ConnectionThreads threads(
        door.listening, 4, 4, [&](int socket) { house.serve(socket); }, [&](int socket) { house.refuse(socket); });
    threads.stop();
    threads.run();
    EXPECT_EQ(house.served, 0);
}

TEST(ConnectionThreads, EndWhenTheSocketCannotAccept) {
    House house;
    const int deaf = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);  // listens to nothing: EINVAL
    ConnectionThreads threads(
        deaf, 4, 4, [&](int socket) { house.serve(socket); }, [&](int socket) { house.refuse(socket); });
    threads.run();
    EXPECT_EQ(house.served, 0);
    ::close(deaf);
}

}  // namespace
}  // namespace hairbake
