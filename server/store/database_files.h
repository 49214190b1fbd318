// The files of a SQLite database, looked at without SQLite: whether another program overwrote or cut them.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "server/store/file_system.h"

namespace hairbake {

/// The three files of an open database in WAL mode: the file, its log -wal and the index of the log, -shm. Thread-safe.
///
/// The file's header holds a number that grows (Sql::number_file). So a file with a smaller number is an older copy.
/// The formats are those of https://sqlite.org/fileformat2.html and https://sqlite.org/walformat.html.
///
/// To close any descriptor of a file takes the file's locks from SQLite. So this object must live longer than the
/// connections of this process.
class DatabaseFiles {
public:
    /// Opens the files. Gives the index its disk space: SQLite writes it through a mapping, and a mapping without disk
    /// space ends the process.
    /// Throws Error(out_of_resources) when the disk is full.
    explicit DatabaseFiles(const std::filesystem::path& database);

    /// Throws Refusal(busy), telling what to do, when the database file is no database any more, is shorter than
    /// before or has a number that is not from `least` to `most`, or when the log lacks pages that were committed.
    void check(std::int64_t least, std::int64_t most) const;

    /// The number in the header. Nothing when the file has no header of a database.
    std::optional<std::int64_t> number() const;

    /// The same of a database that no connection of this process has open.
    static std::optional<std::int64_t> number_in(const std::filesystem::path& database);

    /// Before a database is opened: the disk must have room for the index.
    /// Throws Error(out_of_resources) when it has not.
    static void require_room(const std::filesystem::path& database);

private:
    void give_index_room() const;
    bool file_is_ours(std::int64_t least, std::int64_t most) const;
    bool log_is_ours() const;

    std::filesystem::path path_;
    Descriptor file_, log_, index_;
    mutable std::atomic<std::int64_t> largest_bytes_ = 0;  ///< the file never shrinks
};

/// For a database that cannot be opened because its disk has too few free bytes.
/// Throws Error(out_of_resources).
[[noreturn]] void throw_disk_full(const std::filesystem::path& database);

}  // namespace hairbake
