#include "server/store/store_advice.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <system_error>

#include "core/base/short_text.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

/// What keeps this process from `path`: the uppermost folder that it may not search, or else `path` or its folder. A
/// link at `path` is followed once.
fs::path closed_at(const fs::path& named) {
    std::error_code no_link;
    const fs::path target = fs::read_symlink(named, no_link);
    const fs::path path = no_link ? named : named.parent_path() / target;
    fs::path above;
    for (const fs::path& part : path) {
        if (!above.empty() && ::faccessat(AT_FDCWD, above.c_str(), X_OK, AT_EACCESS) != 0) return above;
        above /= part;
    }
    struct stat facts {};
    if (::stat(path.c_str(), &facts) != 0) return path.parent_path();
    // A file that may be read and written: its folder forbids to replace it.
    const bool is_open = ::faccessat(AT_FDCWD, path.c_str(), R_OK | W_OK, AT_EACCESS) == 0;
    return is_open && S_ISREG(facts.st_mode) ? path.parent_path() : path;
}

/// "it belongs to user 0 and has the mode 0700"; empty when the system does not tell.
std::string owner_and_mode(const fs::path& path) {
    struct stat facts {};
    if (::stat(path.c_str(), &facts) != 0) return {};
    char mode[8];
    std::snprintf(mode, sizeof mode, "%04o", static_cast<unsigned>(facts.st_mode & 07777));
    return "it belongs to user " + std::to_string(facts.st_uid) + " and has the mode " + mode;
}

std::string advice_to_open(const fs::path& path) {
    const fs::path closed = closed_at(path);
    for (const fs::path& place : {path, closed, path.parent_path()})
        if (const std::optional<char> attribute = protecting_attribute(place))
            return place.string() + " has the attribute " + *attribute +
                   (*attribute == 'i' ? " (immutable)" : " (append only)") +
                   ", which forbids all users to change it. " + "Take it away: `chattr -" + *attribute + " " +
                   place.string() + "`";
    const std::string user = std::to_string(::geteuid()), facts = owner_and_mode(closed);
    return "This program runs as user " + user + " and may not use " + closed.string() +
           (facts.empty() ? "" : ": " + facts) + ". Give owner and mode back: `chown " + user + " " + closed.string() +
           "` and `chmod u+rwX " + closed.string() + "`";
}

}  // namespace

std::optional<char> protecting_attribute(const fs::path& path) {
    struct statx facts {};
    if (::statx(AT_FDCWD, path.c_str(), 0, 0, &facts) != 0) return std::nullopt;
    if (facts.stx_attributes & STATX_ATTR_IMMUTABLE) return 'i';
    if (facts.stx_attributes & STATX_ATTR_APPEND) return 'a';
    return std::nullopt;
}

std::string advice_for(const fs::path& path, int error) {
    switch (error) {
        case EACCES:
        case EPERM:
            return advice_to_open(path);
        case EROFS:
            return "Mount the file system of the store so that it can be written";
        case ENOSPC:
        case EDQUOT:
            return "Make room on its disk: delete inputs that nothing needs (GET /v1/blobs?unneeded=1 lists them), or "
                   "files of other programs";
        case EFBIG:
            return "The file system or a limit of this process (ulimit -f) allows no larger file: raise the limit";
        case ENOENT:
        case ENOTDIR:
        case EISDIR:
        case ELOOP:
            return "Put back what was there before";
        case ENOMEM:
        case EMFILE:
        case ENFILE:
            return "Try again later";
        default:
            return "Check the disk, and the system's log";
    }
}

std::string without_path(std::string text, const fs::path& store) {
    replace_all(text, store.string(), "the store");
    return text;
}

}  // namespace hairbake
