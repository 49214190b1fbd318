// Notices that a file or folder was moved, deleted, replaced or closed while the daemon has it open.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace hairbake {

/// Which files stand at some paths, by device and inode. Immutable, so thread-safe.
class PinnedFiles {
public:
    struct Path {
        std::filesystem::path path;
        std::string advice;  ///< what mends the loss of this file; a sentence without a full stop
    };

    PinnedFiles() = default;
    /// Remembers the files that are at `paths` now; leaves out paths at which there is none.
    explicit PinnedFiles(const std::vector<Path>& paths);

    /// One stat() a path.
    /// Throws Refusal(busy), naming the path, when another file or none is at one of them, and with the system's reason
    /// and what to do when the system does not say which file is there.
    void check() const;

private:
    struct Pin {
        std::filesystem::path path;
        std::string advice;
        dev_t device;
        ino_t inode;
    };
    std::vector<Pin> pins_;
};

}  // namespace hairbake
