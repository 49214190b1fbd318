// Space on the store's disk that only deletions use, so that a full disk does not keep people from making room.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

namespace hairbake {

class Database;

/// The file `reserve` in the store's folder. A deletion writes some kilobytes into the database before it frees its
/// file's bytes. When the disk has no room for them, the reserve's bytes are given to it. Thread-safe.
class DiskReserve {
public:
    static constexpr std::uint64_t bytes = 1 << 20;

    /// `folder` is the store's. The database must outlive this object.
    DiskReserve(const std::filesystem::path& folder, Database& database)
        : file_(folder / "reserve"), database_(database) {}

    /// Makes the file where it is missing. On a disk with less than 16 times its bytes free, nothing happens. Failures
    /// are ignored: without a reserve a deletion on a full disk may be refused.
    void fill();

    /// Runs `deletion`; if the disk is full, frees the reserve and runs it again. `deletion` leaves nothing half done
    /// when it throws.
    /// Throws what `deletion` throws. For a disk that is full all the same the message says that nothing was changed.
    void run(const std::function<void()>& deletion);

private:
    bool release();

    const std::filesystem::path file_;
    Database& database_;
};

}  // namespace hairbake
