#include "server/http/lingering.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <iterator>
#include <system_error>
#include <utility>
#include <vector>

namespace hairbake {
namespace {

constexpr std::size_t most_bytes = 16u << 20;

int new_eventfd() {
    const int file = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (file < 0) throw std::system_error(errno, std::generic_category(), "no eventfd can be made");
    return file;
}

}  // namespace

Lingering::Lingering(std::chrono::milliseconds patience, std::size_t most)
    : patience_(patience), most_(most), wake_(new_eventfd()), thread_([this] { run(); }) {}

Lingering::~Lingering() {
    ending_ = true;
    ::eventfd_write(wake_, 1);
    thread_.join();
    ::close(wake_);
}

Lingering::Held::~Held() {
    if (socket >= 0) ::close(socket);
}

Lingering::Held::Held(Held&& other) noexcept
    : socket(std::exchange(other.socket, -1)), end(other.end), read(other.read) {}

Lingering::Held& Lingering::Held::operator=(Held&& other) noexcept {
    std::swap(socket, other.socket);
    end = other.end;
    read = other.read;
    return *this;
}

void Lingering::add(int socket) {
    Held held(socket, Clock::now() + patience_);
    ::shutdown(socket, SHUT_WR);
    {
        const std::lock_guard lock(mutex_);
        added_.push_back(std::move(held));
        if (added_.size() > most_) added_.pop_front();
    }
    ::eventfd_write(wake_, 1);
}

/// Reads what is there. Returns false when the connection shall be closed.
bool Lingering::still_sends(Held& held) const {
    std::array<char, 16384> sink;
    if (Clock::now() >= held.end) return false;
    const ssize_t count = ::recv(held.socket, sink.data(), sink.size(), MSG_DONTWAIT);
    if (count < 0) return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
    held.read += static_cast<std::size_t>(count);
    return count > 0 && held.read < most_bytes;
}

void Lingering::run() {
    std::deque<Held> all;
    std::vector<pollfd> events;
    while (!ending_) {
        {
            const std::lock_guard lock(mutex_);
            all.insert(all.end(), std::make_move_iterator(added_.begin()), std::make_move_iterator(added_.end()));
            added_.clear();
        }
        std::erase_if(all, [&](Held& held) { return !still_sends(held); });
        while (all.size() > most_) all.pop_front();
        events.assign(1, {wake_, POLLIN, 0});
        for (const Held& held : all) events.push_back({held.socket, POLLIN, 0});
        ::poll(events.data(), events.size(), all.empty() ? -1 : static_cast<int>(patience_.count() / 10));
        eventfd_t ignored = 0;
        ::eventfd_read(wake_, &ignored);
    }
}

}  // namespace hairbake
