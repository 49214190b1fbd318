// The log of files that the store removes or moves away.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace hairbake {

/// Files that one step removed or moved away.
struct FileCount {
    std::uint64_t files = 0, bytes = 0;
};

/// Call it before the record of a file is removed, so that no file stays without one.
/// Throws Refusal(unwritable) with the reason when the file is there and cannot be looked at, its folder cannot be
/// written, or an attribute protects one of them.
void require_removable(const std::filesystem::path& file);

/// Unlinks a file and adds it to `count`. A file that cannot be removed stays, with a line in the log.
void remove_counted(const std::filesystem::path& file, FileCount& count);

/// Removes a file, or a folder with all that is in it, and adds its files to `count`.
void remove_tree_counted(const std::filesystem::path& path, FileCount& count);

/// Writes a line "removed N files of B bytes: REASON". No line for no files.
void log_removal(const FileCount& removed, std::string_view reason);

/// Writes a warning "moved N files of B bytes to FOLDER: REASON". No line for no files.
void log_move(const FileCount& moved, const std::filesystem::path& folder, std::string_view reason);

/// Writes a warning "FOLDER holds N files of B bytes". No line for no files.
void log_held(const FileCount& held, const std::filesystem::path& folder);

}  // namespace hairbake
