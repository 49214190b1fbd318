#include "server/store/store_access.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>

#include "core/base/error.h"
#include "server/store/file_system.h"
#include "server/store/store_advice.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

std::string advice_to_start(const fs::path& store, int error) {
    if (error == ENOTDIR || error == EEXIST) return "Let [store] folder name the folder of a store, or an empty one";
    if (error != EACCES && error != EPERM) return advice_for(store, error);
    const std::string user = std::to_string(::geteuid()), folder = store.string();
    return "This program runs as user " + user + ". If " + folder +
           " is its store, give owner and mode back: `chown -R " + user + " " + folder + "` and `chmod -R u+rwX " +
           folder + "`. If not, start the program as the owner of the store";
}

[[noreturn]] void stop(const fs::path& store, const fs::path& path, const char* what, int error) {
    throw Error(ErrorKind::bad_input,
                path.string() + " cannot be " + what + ": " + std::generic_category().message(error) +
                    ". Nothing was changed or removed. " + advice_to_start(store, error),
                {}, error);
}

}  // namespace

void check_access(const fs::path& store, const fs::path& path, bool to_write) {
    struct stat facts {};
    if (::stat(path.c_str(), &facts) != 0) {
        if (errno == ENOENT) return;
        stop(store, path, "read", errno);
    }
    const int search = S_ISDIR(facts.st_mode) ? X_OK : 0;
    if (::faccessat(AT_FDCWD, path.c_str(), R_OK | search, AT_EACCESS) != 0) stop(store, path, "read", errno);
    if (to_write && ::faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) != 0) stop(store, path, "written", errno);
}

void give_owner_of(const fs::path& model, int descriptor) {
    struct stat wanted {
    }, found{};
    if (::geteuid() != 0 || ::stat(model.c_str(), &wanted) != 0 || ::fstat(descriptor, &found) != 0) return;
    if (wanted.st_uid == found.st_uid && wanted.st_gid == found.st_gid) return;
    [[maybe_unused]] const int is_forbidden = ::fchown(descriptor, wanted.st_uid, wanted.st_gid);
}

void make_store_folder(const fs::path& store, const fs::path& folder) {
    std::error_code error;
    const bool is_new = fs::create_directories(folder, error);
    const int code = error.value();
    if (code == EACCES || code == EPERM || code == EROFS || code == ENOTDIR || code == EEXIST)
        stop(store, folder, "made", code);
    if (code != 0) throw_store_error(folder, code);
    if (!is_new || folder == store) return;
    const Descriptor made(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (made) give_owner_of(store, made.get());
}

}  // namespace hairbake
