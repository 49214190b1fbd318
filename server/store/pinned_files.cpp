#include "server/store/pinned_files.h"

#include <sys/stat.h>

#include <cerrno>
#include <system_error>

#include "server/store/refusal.h"
#include "server/store/store_advice.h"

namespace hairbake {

PinnedFiles::PinnedFiles(const std::vector<Path>& paths) {
    for (const Path& pinned : paths)
        if (struct stat facts{}; ::stat(pinned.path.c_str(), &facts) == 0)
            pins_.push_back({pinned.path, pinned.advice, facts.st_dev, facts.st_ino});
}

void PinnedFiles::check() const {
    for (const Pin& pin : pins_) {
        struct stat facts {};
        const int error = ::stat(pin.path.c_str(), &facts) == 0 ? 0 : errno;
        if (error == 0 && facts.st_dev == pin.device && facts.st_ino == pin.inode) continue;
        const std::string path = pin.path.string();
        const bool is_gone = error == ENOENT || error == ENOTDIR;
        if (error != 0 && !is_gone)
            throw Refusal(Refused::busy, path + " cannot be reached: " + std::generic_category().message(error) +
                                             "; nothing is written. " + advice_for(pin.path, error));
        throw Refusal(Refused::busy, path + " was " + (is_gone ? "moved or deleted" : "replaced") +
                                         " while the daemon works with it; nothing is written. " + pin.advice);
    }
}

}  // namespace hairbake
