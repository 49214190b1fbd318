#include "server/http/connection.h"
#include "server/http/lingering.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <string>
#include <thread>

namespace hairbake {
namespace {

using namespace std::chrono_literals;
constexpr Connection::Patience short_patience{.head = 20ms, .read = 20ms, .write = 20ms};
constexpr Connection::Patience long_patience{.head = 60s, .read = 60s, .write = 60s};

/// A connection and the client's end of it.
struct Pair {
    explicit Pair(const Connection::Patience& patience) : Pair(patience, make()) {}
    Pair(const Connection::Patience& patience, std::array<int, 2> ends)
        : client(ends[1]), connection(ends[0], patience) {}
    ~Pair() { hang_up(); }

    static std::array<int, 2> make() {
        std::array<int, 2> ends{};
        EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()), 0);
        return ends;
    }
    void send(const std::string& text) const {
        EXPECT_EQ(::send(client, text.data(), text.size(), MSG_NOSIGNAL), ssize_t(text.size()));
    }
    /// The bytes that the client can read now.
    std::string received() const {
        std::string text(1 << 16, '\0');
        const ssize_t count = ::recv(client, text.data(), text.size(), MSG_DONTWAIT);
        text.resize(count > 0 ? std::size_t(count) : 0);
        return text;
    }
    void hang_up() {
        if (client >= 0) ::close(client);
        client = -1;
    }

    int client;
    Connection connection;
};

bool always() { return true; }

std::string read(Connection& connection, std::size_t size) {
    std::string text(size, '\0');
    const ssize_t count = connection.read(text.data(), size);
    text.resize(count > 0 ? std::size_t(count) : 0);
    return text;
}

/// Bytes in which a lost, doubled or swapped piece shows.
std::string numbered(std::size_t size) {
    std::string bytes(size, '\0');
    for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>((i * 2654435761u) >> 13);
    return bytes;
}

TEST(Connection, ReadsByteByByteWhatTheClientSentAtOnceAndThenItsEnd) {
    Pair pair(long_patience);
    pair.send("GET / HTTP/1.1");
    pair.hang_up();
    ASSERT_TRUE(pair.connection.await_head(always));
    std::string text;
    for (std::string byte; !(byte = read(pair.connection, 1)).empty();) text += byte;
    EXPECT_EQ(text, "GET / HTTP/1.1");
    char byte = 0;
    EXPECT_EQ(pair.connection.read(&byte, 1), 0) << "closed is not the same as silent";
}

TEST(Connection, HeadAndBodyLeaveTogetherWhenFlushed) {
    Pair pair(long_patience);
    pair.connection.write("head ", 5);
    pair.connection.write("body", 4);
    EXPECT_EQ(pair.received(), "");
    EXPECT_TRUE(pair.connection.flush());
    EXPECT_EQ(pair.received(), "head body");
}

TEST(Connection, WhatWasWrittenLeavesBeforeMoreIsRead) {
    // "100 Continue" must be out before the body is waited for, or both sides wait.
    Pair pair(short_patience);
    pair.connection.write("continue", 8);
    char byte = 0;
    EXPECT_EQ(pair.connection.read(&byte, 1), -1);
    EXPECT_EQ(pair.received(), "continue");
}

TEST(Connection, AClientThatReadsSlowlyGetsEveryByteInOrder) {
    // Many times what a socket holds (some 200 KiB), in pieces smaller and larger than the write buffer (16 KiB).
    Pair pair(long_patience);
    const std::string sent = numbered(8 << 20);
    std::string got;
    std::jthread client([&] {
        std::array<char, 3000> piece;
        for (ssize_t count; (count = ::recv(pair.client, piece.data(), piece.size(), 0)) > 0;)
            got.append(piece.data(), std::size_t(count));
    });
    for (std::size_t at = 0, piece = 1; at < sent.size(); at += piece, piece = piece * 3 % 40'000 + 1) {
        piece = std::min(piece, sent.size() - at);
        ASSERT_EQ(pair.connection.write(sent.data() + at, piece), ssize_t(piece));
    }
    ASSERT_TRUE(pair.connection.flush());
    ::shutdown(pair.connection.socket(), SHUT_WR);
    client.join();
    EXPECT_TRUE(got == sent);
}

TEST(Connection, LargeAndSmallReadsMixWithoutLosingAByte) {
    Pair pair(long_patience);
    const std::string sent = numbered(1 << 20);
    std::jthread client([&] {
        for (std::size_t at = 0; at < sent.size(); at += 7919) pair.send(sent.substr(at, 7919));
        ::shutdown(pair.client, SHUT_WR);
    });
    std::string got;
    ASSERT_TRUE(pair.connection.await_head(always));
    for (std::size_t size = 1;; size = size * 5 % 20'000 + 1) {
        const std::string piece = read(pair.connection, size);
        if (piece.empty()) break;
        got += piece;
    }
    EXPECT_TRUE(got == sent);
}

TEST(Connection, AClientThatIsSilentOrDoesNotReadIsGivenUp) {
    Pair pair(short_patience);
    EXPECT_FALSE(pair.connection.await_head(always));
    char byte = 0;
    EXPECT_EQ(pair.connection.read(&byte, 1), -1);
    const std::string more_than_a_socket_holds(8 << 20, 'x');
    EXPECT_EQ(pair.connection.write(more_than_a_socket_holds.data(), more_than_a_socket_holds.size()), -1);
}

TEST(Connection, NobodyIsWaitedForAnyMoreWhenTheServiceEnds) {
    Pair pair(long_patience);  // else the test lasts a minute
    int asked = 0;
    EXPECT_FALSE(pair.connection.await_head([&] { return ++asked < 3; }));
}

TEST(Connection, AClientThatIsGoneIsAFailureAndNoSignal) {
    Pair pair(long_patience);
    pair.hang_up();
    pair.connection.write("reply", 5);
    EXPECT_FALSE(pair.connection.flush());
}

/// What the client receives next; 0 is the end of the connection. Waits.
ssize_t next_received(int client) {
    char byte = 0;
    return ::recv(client, &byte, 1, 0);
}

TEST(Lingering, ReadsAwayWhatAClientStillSends) {
    Lingering lingering(60s, 10);
    Pair pair(long_patience);
    lingering.add(pair.connection.release());
    EXPECT_EQ(next_received(pair.client), 0);  // sending is shut down
    // More than a socket holds: the client would wait for ever if nobody read it.
    const std::string body(4 << 20, 'x');
    EXPECT_EQ(::send(pair.client, body.data(), body.size(), MSG_NOSIGNAL), ssize_t(body.size()));
}

TEST(Lingering, ClosesTheOldestWhenThereAreTooMany) {
    Lingering lingering(60s, 1);
    Pair oldest(long_patience), newest(long_patience);
    lingering.add(oldest.connection.release());
    lingering.add(newest.connection.release());
    while (::send(oldest.client, "x", 1, MSG_NOSIGNAL) == 1) std::this_thread::yield();  // until it is closed
    EXPECT_EQ(::send(newest.client, "x", 1, MSG_NOSIGNAL), 1);
}

TEST(Lingering, ClosesAllAtItsEnd) {
    Pair pair(long_patience);
    {
        Lingering lingering(60s, 10);
        lingering.add(pair.connection.release());
    }
    EXPECT_EQ(::send(pair.client, "x", 1, MSG_NOSIGNAL), -1);
}

}  // namespace
}  // namespace hairbake
