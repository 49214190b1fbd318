#include "server/http/connection.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace hairbake {
namespace {

using std::chrono::milliseconds;
constexpr std::size_t most_held = 16384;
constexpr milliseconds glance(10);  // how often `still_wanted` is asked

bool must_wait() { return errno == EAGAIN || errno == EWOULDBLOCK; }

/// Repeats `call` while a signal interrupts it.
template <class Call>
ssize_t uninterrupted(Call call) {
    for (;;) {
        const ssize_t count = call();
        if (count >= 0 || errno != EINTR) return count;
    }
}

}  // namespace

Connection::Connection(int socket, const Patience& patience)
    : socket_(socket), patience_(patience), head_end_(Clock::now() + patience.head) {}

Connection::~Connection() {
    if (socket_ >= 0) ::close(socket_);
}

bool Connection::await(short event, milliseconds patience) const {
    const auto end = Clock::now() + patience;
    const ssize_t count = uninterrupted([&] {
        const auto left = std::chrono::ceil<milliseconds>(end - Clock::now()).count();
        pollfd ready{socket_, event, 0};
        return ssize_t(::poll(&ready, 1, static_cast<int>(std::max<decltype(left)>(left, 0))));
    });
    return count > 0;
}

bool Connection::await_readable() const { return ahead_begin_ < ahead_end_ || await(POLLIN, patience_.read); }

bool Connection::await_writable() const { return await(POLLOUT, patience_.write); }

/// Does not wait.
ssize_t Connection::receive(char* data, std::size_t size) const {
    return uninterrupted([&] { return ::recv(socket_, data, size, MSG_DONTWAIT); });
}

ssize_t Connection::send(const char* data, std::size_t size) const {
    return uninterrupted([&] { return ::send(socket_, data, size, MSG_DONTWAIT | MSG_NOSIGNAL); });
}

bool Connection::await_head(const std::function<bool()>& still_wanted) { return fill(still_wanted, head_end_); }

bool Connection::await_more(const std::function<bool()>& still_wanted) {
    return fill(still_wanted, Clock::now() + patience_.read);
}

/// Fills the read buffer if it is empty.
bool Connection::fill(const std::function<bool()>& still_wanted, Clock::time_point end) {
    if (has_unread()) return true;
    ssize_t count = receive(ahead_.data(), ahead_.size());  // usually the request is there already
    while (count < 0 && must_wait() && still_wanted() && Clock::now() < end) {
        await(POLLIN, glance);
        count = receive(ahead_.data(), ahead_.size());
    }
    is_closed_ = count == 0 || (count < 0 && !must_wait());
    ahead_begin_ = 0;
    ahead_end_ = static_cast<std::size_t>(std::max<ssize_t>(count, 0));
    return count > 0;
}

ssize_t Connection::read(char* data, std::size_t size) {
    if (size == 1 && ahead_begin_ < ahead_end_) {  // the library reads a head byte by byte
        *data = ahead_[ahead_begin_++];
        return 1;
    }
    if (ahead_begin_ == ahead_end_) {
        if (!flush()) return -1;
        const bool whole = size >= ahead_.size();  // large: past the buffer
        char* const into = whole ? data : ahead_.data();
        const std::size_t room = whole ? size : ahead_.size();
        ssize_t count = receive(into, room);
        if (count < 0 && must_wait() && await_readable()) count = receive(into, room);
        if (whole || count <= 0) return count;
        ahead_begin_ = 0;
        ahead_end_ = static_cast<std::size_t>(count);
    }
    const std::size_t count = std::min(size, ahead_end_ - ahead_begin_);
    std::copy_n(ahead_.data() + ahead_begin_, count, data);
    ahead_begin_ += count;
    return static_cast<ssize_t>(count);
}

ssize_t Connection::write(const char* data, std::size_t size) {
    if (held_.size() + size > most_held) {
        if (!flush() || (size > most_held && !send_all(data, size))) return -1;
        if (size > most_held) return static_cast<ssize_t>(size);
    }
    held_.append(data, size);
    return static_cast<ssize_t>(size);
}

bool Connection::flush() {
    const bool sent = send_all(held_.data(), held_.size());
    held_.clear();
    return sent;
}

bool Connection::send_all(const char* data, std::size_t size) const {
    while (size > 0) {
        const ssize_t count = send(data, size);
        if (count < 0 && must_wait() && await_writable()) continue;
        if (count <= 0) return false;
        data += count;
        size -= static_cast<std::size_t>(count);
    }
    return true;
}

}  // namespace hairbake
