#include "server/http/request_reader.h"

#include <chrono>
#include <cstdint>
#include <string_view>
#include <utility>

namespace hairbake {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::size_t longest_head = 64 << 10;  // as in nginx.conf

std::string seconds_text(std::chrono::milliseconds time) {
    return std::to_string(std::chrono::duration_cast<std::chrono::seconds>(time).count()) + " s";
}

}  // namespace

RequestReader::RequestReader(Connection& connection, const BodyPace::Limits& pace, std::function<bool()> keeps_thread)
    : connection_(connection), pace_(pace), keeps_thread_(std::move(keeps_thread)) {}

ssize_t RequestReader::read(char* data, std::size_t size) {
    if (!given_up_.empty()) return -1;
    if (in_head_) return read_head(data, size);
    if (std::exchange(client_waits_, false) && !send_continue()) return -1;
    return connection_.has_unread() ? connection_.read(data, size) : read_body(data, size);
}

void RequestReader::end_head(bool client_waits, bool is_short) {
    in_head_ = false;
    client_waits_ = client_waits;
    is_short_ = is_short;
}

bool RequestReader::send_continue() {
    constexpr std::string_view reply = "HTTP/1.1 100 Continue\r\n\r\n";
    return connection_.has_unread() || (connection_.write(reply.data(), reply.size()) >= 0 && connection_.flush());
}

ssize_t RequestReader::read_head(char* data, std::size_t size) {
    if (++head_bytes_ > longest_head) return -1;  // the library reads a head byte by byte
    if (connection_.await_head(keeps_thread_)) return connection_.read(data, size);
    if (connection_.is_closed()) return 0;
    given_up_ = "the head of the request did not arrive within " + seconds_text(connection_.patience().head) +
                ", or not at once while other connections waited: send it again, whole";
    return -1;
}

ssize_t RequestReader::read_body(char* data, std::size_t size) {
    const Clock::time_point begin = Clock::now();
    if (is_short_ && !connection_.await_more(keeps_thread_)) {
        if (!connection_.is_closed())
            given_up_ = "the body did not arrive in time, or not at once while other connections waited: send it again";
        return connection_.is_closed() ? 0 : -1;
    }
    const ssize_t count = connection_.read(data, size);
    if (count <= 0 || pace_.add(static_cast<std::uint64_t>(count), Clock::now() - begin)) return count;
    given_up_ = "the body brought fewer than " + std::to_string(pace_.limits().bytes_per_second) +
                " bytes a second, as the mean of " + seconds_text(pace_.limits().window) +
                " ([listen] body_rate, body_window_s): send it over a faster connection, or as a resumable upload "
                "(/v1/uploads), which keeps what arrived";
    return -1;
}

}  // namespace hairbake
