// Resumable uploads (tus 1.0: core, creation, termination, expiration).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>

namespace hairbake {

class BlobStore;
class Database;
class DiskReserve;
class Room;

struct UploadState {
    std::string id, metadata, sha256;  ///< sha256: digest of the whole file
    std::uint64_t bytes = 0, offset = 0;
    double expires = 0;
};

/// Thread-safe; one upload grows by one request at a time. An upload's file is `folder`/<id>; its size is the offset.
class Uploads {
public:
    using Receiver = std::function<void(std::span<const std::byte>)>;

    struct Limits {
        double lifetime_s = 0;         ///< of an upload that does not grow
        std::uint64_t most_bytes = 0;  ///< of one upload
        std::uint64_t budget = 0;      ///< what all unfinished uploads together may announce
        int most_open = 0;             ///< unfinished uploads of one token
    };
    Uploads(Database& database, BlobStore& store, Room& room, DiskReserve& reserve, std::filesystem::path folder,
            const Limits& limits);

    /// At boot: moves files without a row to lost+found, and removes those that are empty or a second link to a blob's
    /// file; removes rows without a file; makes blobs of uploads that are whole.
    void recover();
    /// Removes expired uploads.
    void expire();

    /// `sha256` is the digest of the whole file; `token` names the sender. The announced bytes take no room yet: their
    /// room is reserved while they arrive.
    /// Throws Refusal(too_many) when the token has too many unfinished uploads, or when they would announce more than
    /// half of the budget.
    /// Throws Refusal(full) when all unfinished uploads together would announce more than the budget, or when the file
    /// has no room now.
    UploadState create(std::uint64_t bytes, const std::string& sha256, const std::string& metadata,
                       const std::string& token);
    /// Throws Refusal(not_found) when there is no such upload, or its bytes were lost.
    /// Throws Refusal(busy) when the folder of all uploads is away.
    /// Throws as throw_store_error() when its file cannot be looked at.
    UploadState get(const std::string& id);

    struct Appended {
        std::uint64_t offset = 0;
        double expires = 0;
        std::string blob;  ///< digest, once complete; then the upload is gone
    };
    /// Appends bytes durably. Makes the file a blob when it is complete. Bytes received before a failure stay.
    ///
    /// `offset` must be the upload's.
    /// `length` is that of the body, if it is known.
    /// `read` feeds the bytes to the receiver that it is given.
    /// Throws Refusal(conflict) for another offset and while another request writes to the upload.
    /// Throws Refusal(too_large) when the upload would grow beyond its length.
    /// Throws Refusal(full) when the bytes have no room.
    Appended append(const std::string& id, std::uint64_t offset, std::optional<std::uint64_t> length,
                    const std::function<void(const Receiver&)>& read);
    /// `reason` is for the log.
    /// Throws Refusal(not_found) when there is no such upload.
    /// Throws Refusal(conflict) while a request writes to it.
    /// Throws as DiskReserve::run().
    void remove(const std::string& id, std::string_view reason = "the upload was deleted on request");

private:
    struct Busy;
    struct Growth;
    void check(std::uint64_t bytes, const std::string& sha256, const std::string& token);
    void receive(const UploadState& state, std::optional<std::uint64_t> length,
                 const std::function<void(const Receiver&)>& read);
    void forget(const std::string& id, std::string_view reason);
    std::uint64_t size_on_disk(const std::string& id) const;
    std::uint64_t offset_of(const std::string& id) const;
    bool is_blob_file(const std::filesystem::path& file) const;
    void clear_unknown();
    double prolong(const std::string& id);
    Appended complete(const std::string& id);
    void make_blob(const std::string& id, const std::string& digest);
    void complete_whole_ones();

    Database& database_;
    BlobStore& store_;
    Room& room_;
    DiskReserve& reserve_;
    std::filesystem::path folder_;
    const Limits limits_;
    std::mutex mutex_;
    std::set<std::string> busy_;
};

}  // namespace hairbake
