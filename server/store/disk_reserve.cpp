#include "server/store/disk_reserve.h"

#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "core/base/error.h"
#include "server/store/database.h"
#include "server/store/file_system.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t least_free = 16 * DiskReserve::bytes;

bool is_filled(const fs::path& file) {
    struct stat facts {};
    return ::lstat(file.c_str(), &facts) == 0 && S_ISREG(facts.st_mode) &&
           static_cast<std::uint64_t>(facts.st_size) >= DiskReserve::bytes;
}

bool has_room(const fs::path& folder) {
    struct statvfs disk {};
    return ::statvfs(folder.c_str(), &disk) == 0 &&
           static_cast<std::uint64_t>(disk.f_bavail) * disk.f_frsize >= least_free;
}

}  // namespace

void DiskReserve::fill() {
    if (is_filled(file_) || !has_room(file_.parent_path())) return;
    const auto held = database_.lock();
    ::unlink(file_.c_str());  // half of one, left by a crash
    const Descriptor reserve(::open(file_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0640));
    if (reserve && ::posix_fallocate(reserve.get(), 0, static_cast<off_t>(bytes)) == 0) return;
    if (reserve) ::unlink(file_.c_str());
}

/// Whether there was a reserve.
bool DiskReserve::release() {
    if (!is_filled(file_) || ::unlink(file_.c_str()) != 0) return false;
    spdlog::warn("the disk of {} is full: the {} bytes of {} are given to a deletion", file_.parent_path().string(),
                 bytes, file_.filename().string());
    return true;
}

void DiskReserve::run(const std::function<void()>& deletion) {
    {
        const auto held = database_.lock();  // no other transaction takes the freed bytes
        try {
            deletion();
        } catch (const Error& error) {
            if (error.kind() != ErrorKind::out_of_resources) throw;
            if (!release()) throw Error(error.kind(), std::string("nothing was changed: ") + error.what());
            deletion();
        }
    }
    fill();
}

}  // namespace hairbake
