// A file that is being received: its digest is computed while the bytes are written.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "core/base/digest.h"
#include "server/store/room.h"

namespace hairbake {

/// What happens when the received bytes cannot be written.
enum class WhenFull {
    refuse,  ///< the body is refused
    compare  ///< they are stored already: the rest is received without a file, for its digest alone
};

/// Not thread-safe. The destructor removes the file unless a store has adopted it.
class IncomingFile {
public:
    /// Receives up to `limit` bytes without a file, for their digest alone.
    explicit IncomingFile(std::uint64_t limit) : limit_(limit) {}

    /// A new file of a random name in `folder`; at most `limit` bytes may be added, and they take their room of
    /// `share`.
    IncomingFile(const std::filesystem::path& folder, std::uint64_t limit,
                 std::optional<Room::Share> share = std::nullopt, WhenFull when_full = WhenFull::refuse);
    ~IncomingFile();
    IncomingFile(const IncomingFile&) = delete;
    IncomingFile& operator=(const IncomingFile&) = delete;

    /// Throws Refusal(too_large) beyond the limit.
    /// Throws Refusal(full) when there is no room.
    /// Throws Error(out_of_resources) for a full disk.
    void add(std::span<const std::byte> bytes);

    /// Syncs and closes the file; digest() is valid from now on, and nothing may be added any more.
    void finish();

    /// The bytes take room of the store's budget for sure: see Room::Share::count().
    void count();
    /// Call it with database.lock() held when the file has become a blob.
    void give_back();

    /// Whether there is a file; there is always one with WhenFull::refuse.
    bool has_file() const { return !path_.empty(); }
    const std::filesystem::path& path() const { return path_; }
    std::uint64_t bytes() const { return bytes_; }
    const std::string& digest() const { return hex_; }

private:
    void write(std::span<const std::byte> bytes);
    void close_file();
    void drop_file();

    std::filesystem::path path_;
    std::uint64_t limit_, bytes_ = 0;
    int descriptor_ = -1;
    WhenFull when_full_ = WhenFull::refuse;
    Digest digest_;
    std::string hex_;
    std::optional<Room::Share> share_;
};

}  // namespace hairbake
