// Space on the store's disk that only deletions use, so that a full disk does not keep people from making room.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <utility>
#include <vector>

#include "core/base/error.h"

namespace hairbake {

class Database;

/// A deletion found no room on the disk for its transaction, after all its checks. Nothing was changed.
class DeletionNeedsRoom : public Error {
public:
    /// `files`: those that the deletion removes when its transaction is committed.
    DeletionNeedsRoom(const Error& error, std::vector<std::filesystem::path> files)
        : Error(error.kind(), error.what(), error.field(), error.system_error()), files_(std::move(files)) {}

    const std::vector<std::filesystem::path>& files() const { return files_; }

private:
    std::vector<std::filesystem::path> files_;
};

/// The file `reserve` in the store's folder. A deletion writes some kilobytes into the database before it frees its
/// file's bytes. When the disk has no room for them, the reserve's bytes are given to it. Thread-safe.
class DiskReserve {
public:
    static constexpr std::uint64_t bytes = 1 << 20;
    /// A deletion needs some 100 KiB: pages of the database's log and of its index.
    static constexpr std::uint64_t enough = 256 << 10;

    /// `folder` is the store's. The database must outlive this object.
    DiskReserve(const std::filesystem::path& folder, Database& database)
        : file_(folder / "reserve"), database_(database) {}

    /// Makes the file, or makes it larger, as far as half of the disk's free bytes allow. Failures are ignored: then a
    /// later deletion has other ways.
    void fill();

    /// Runs `deletion`, which leaves nothing half done when it throws. While the disk is full it is repeated, each time
    /// with more room:
    ///
    ///   1. the reserve is removed;
    ///   2. the database's log is written into the database and cut;
    ///   3. the files of DeletionNeedsRoom are cut to nothing, if they have `enough` bytes. Their deletion was asked
    ///      for and nothing speaks against it. After a crash at this moment, the next start finds files of the wrong
    ///      size.
    ///
    /// The reserve is filled again from what was freed, before another transaction can take it.
    /// Throws what `deletion` throws. For a disk that is full all the same the message tells what works.
    void run(const std::function<void()>& deletion);

    /// Before the database is opened, which needs some pages: removes the reserve if the disk has less than `enough`
    /// bytes free.
    static void release_if_full(const std::filesystem::path& folder);

private:
    bool run_with_help(const std::function<void()>& deletion);
    bool release();
    void grow(std::uint64_t most);

    const std::filesystem::path file_;
    Database& database_;
};

}  // namespace hairbake
