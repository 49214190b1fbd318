#include "server/store/removal_log.h"

#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "core/base/error.h"
#include "server/store/file_system.h"
#include "server/store/refusal.h"
#include "server/store/store_advice.h"

namespace hairbake {
namespace fs = std::filesystem;

void require_removable(const fs::path& file) try {
    struct stat facts {};
    if (::lstat(file.c_str(), &facts) != 0) {
        if (errno == ENOENT || errno == ENOTDIR) return;
        throw_store_error(file, errno);
    }
    if (::faccessat(AT_FDCWD, file.parent_path().c_str(), W_OK | X_OK, AT_EACCESS) != 0) throw_store_error(file, errno);
    if (protecting_attribute(file) || protecting_attribute(file.parent_path())) throw_store_error(file, EPERM);
} catch (const Error& error) {  // not for a full disk: a deletion has a reserve for that (disk_reserve.h)
    throw Refusal(Refused::unwritable, error.what());
}

void remove_counted(const fs::path& file, FileCount& count) {
    std::error_code unknown;
    const std::uintmax_t bytes = fs::file_size(file, unknown);
    if (::unlink(file.c_str()) != 0) {
        const int error = errno;
        if (error != ENOENT && error != EISDIR)
            spdlog::error("{} is not needed any more and cannot be removed: {}", file.string(),
                          std::generic_category().message(error));
        return;
    }
    ++count.files;
    count.bytes += unknown ? 0 : bytes;
}

void remove_tree_counted(const fs::path& path, FileCount& count) {
    std::error_code error;
    if (fs::symlink_status(path, error).type() != fs::file_type::directory) return remove_counted(path, count);
    for (const fs::directory_entry& entry : fs::directory_iterator(path, error))
        remove_tree_counted(entry.path(), count);
    ::rmdir(path.c_str());
}

void log_removal(const FileCount& removed, std::string_view reason) {
    if (removed.files > 0) spdlog::info("removed {} files of {} bytes: {}", removed.files, removed.bytes, reason);
}

void log_move(const FileCount& moved, const fs::path& folder, std::string_view reason) {
    if (moved.files > 0)
        spdlog::warn("moved {} files of {} bytes to {}: {}", moved.files, moved.bytes, folder.string(), reason);
}

void log_held(const FileCount& held, const fs::path& folder) {
    if (held.files > 0)
        spdlog::warn("{} holds {} files of {} bytes, which the budget does not count; look at them and delete them",
                     folder.string(), held.files, held.bytes);
}

}  // namespace hairbake
