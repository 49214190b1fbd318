#include "server/store/pinned_files.h"

#include <sys/stat.h>

#include <cerrno>

#include "server/store/refusal.h"

namespace hairbake {

PinnedFiles::PinnedFiles(const std::vector<std::filesystem::path>& paths) {
    for (const std::filesystem::path& path : paths)
        if (struct stat facts{}; ::stat(path.c_str(), &facts) == 0) pins_.push_back({path, facts.st_dev, facts.st_ino});
}

void PinnedFiles::check() const {
    for (const Pin& pin : pins_) {
        struct stat facts {};
        const bool found = ::stat(pin.path.c_str(), &facts) == 0;
        if (found && facts.st_dev == pin.device && facts.st_ino == pin.inode) continue;
        const bool gone = !found && errno == ENOENT;
        throw Refusal(Refused::busy, pin.path.string() + " was " + (gone ? "moved or deleted" : "replaced") +
                                         " while the daemon works with it; nothing is written. Put the file back that "
                                         "was there before; docs/deployment.md tells how to save a deleted database");
    }
}

}  // namespace hairbake
