#include "server/worker/shortage.h"

#include <fcntl.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <latch>

namespace hairbake {
namespace {

constexpr std::uint64_t small_piece = 64 << 20;
constexpr std::size_t more_threads = 32, small_stack = 128 << 10;

void* wait_for(void* latch) {
    static_cast<std::latch*>(latch)->wait();
    return nullptr;
}

}  // namespace

bool memory_limit_refuses(std::uint64_t bytes) {
    rlimit limit{};
    if (::getrlimit(RLIMIT_DATA, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return false;
    char text[256] = "";  // pages: size, resident, shared, text, 0, data and stack
    const int file = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
    const ssize_t count = file < 0 ? -1 : ::read(file, text, sizeof text - 1);
    if (file >= 0) ::close(file);
    unsigned long long data = 0;
    if (count <= 0 || std::sscanf(text, "%*u %*u %*u %*u %*u %llu", &data) != 1) return true;  // likelier than not
    return data * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) + bytes > limit.rlim_cur;
}

bool machine_is_short_of_memory() {
    if (memory_limit_refuses(small_piece)) return false;
    void* const piece = ::mmap(nullptr, small_piece, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (piece == MAP_FAILED) return true;
    ::munmap(piece, small_piece);
    return false;
}

bool machine_is_short_of_threads() {
    if (memory_limit_refuses(more_threads * small_stack)) return false;
    std::latch end(1);
    pthread_attr_t attributes;
    ::pthread_attr_init(&attributes);
    ::pthread_attr_setstacksize(&attributes, small_stack);
    std::array<pthread_t, more_threads> threads{};
    std::size_t count = 0;
    while (count < more_threads && ::pthread_create(&threads[count], &attributes, wait_for, &end) == 0) ++count;
    end.count_down();
    for (std::size_t i = 0; i < count; ++i) ::pthread_join(threads[i], nullptr);
    ::pthread_attr_destroy(&attributes);
    return count < more_threads;
}

}  // namespace hairbake
