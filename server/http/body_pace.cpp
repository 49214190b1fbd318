#include "server/http/body_pace.h"

namespace hairbake {

bool BodyPace::add(std::uint64_t bytes, std::chrono::nanoseconds waited) {
    bytes_ += bytes;
    waited_ += waited;
    if (limits_.bytes_per_second == 0 || waited_ < limits_.window) return true;
    const double wanted =
        static_cast<double>(limits_.bytes_per_second) * std::chrono::duration<double>(waited_).count();
    const bool is_enough = static_cast<double>(bytes_) >= wanted;
    bytes_ = 0;
    waited_ = {};
    return is_enough;
}

}  // namespace hairbake
