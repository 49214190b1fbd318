// The folder lost+found of a store: files that the database does not know, and spoiled files.
#pragma once

#include <filesystem>

#include "server/store/removal_log.h"

namespace hairbake {

/// Moves files to `store`/lost+found/TIME/, under their path inside of the store. TIME is the time of the construction.
/// The daemon never removes anything there. Not thread-safe.
class LostFound {
public:
    explicit LostFound(std::filesystem::path store);

    /// Moves a file or folder of the store and adds it to `count`. When it cannot be moved (an ext4 file system has a
    /// folder lost+found of root's), it stays where it is, with a warning in the log.
    void take(const std::filesystem::path& file, FileCount& count);

    /// What all starts have moved and nobody has taken away yet.
    FileCount held() const;

    /// Where take() moves files.
    const std::filesystem::path& folder() const { return folder_; }

private:
    std::filesystem::path store_, folder_;
};

}  // namespace hairbake
