// The blob store: files named by the digest of their bytes.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "server/store/file_system.h"
#include "server/store/incoming_file.h"

namespace hairbake {

class Database;
class Sql;

/// Whether `text` is 64 lower-case hexadecimal digits.
bool is_digest(const std::string& text);

/// Path of a blob in the folder blobs: "ab/<sha256>".
std::string blob_name(const std::string& digest);

/// A blob is missing, or its bytes do not have its digest. The store has already forgotten it and called OnLoss, both
/// in one transaction.
class LostBlob : public std::runtime_error {
public:
    explicit LostBlob(const std::string& digest)
        : std::runtime_error("the stored bytes of sha256:" + digest + " were lost or spoiled") {}
};

/// Where a blob's bytes come from: a client sent them, or a worker made them.
enum class Origin { sent, made };

struct OpenBlob {
    Descriptor file;
    std::uint64_t bytes = 0;
};

/// `folder`/blobs/ab/<sha256>, `folder`/tmp and the table `blobs`. Thread-safe. docs/architecture.md tells how a blob
/// becomes durable.
class BlobStore {
public:
    /// Called in the transaction that forgets a lost blob, to update the rows that refer to it.
    using OnLoss = std::function<void(Sql&)>;

    BlobStore(const std::filesystem::path& folder, Database& database);

    /// At boot, before anything else: removes the entries of tmp/ but those in `spared`, removes blobs without a row,
    /// and forgets rows without a whole file. Returns how many rows it forgot; Queue::recover() updates what refers to
    /// them.
    std::size_t recover(const std::set<std::string>& spared = {});

    std::filesystem::path incoming_folder() const { return folder_ / "tmp"; }
    std::filesystem::path path_of(const std::string& digest) const;

    /// Size in bytes, or nothing when there is no such blob.
    std::optional<std::uint64_t> size_of(const std::string& digest);
    std::uint64_t total_bytes() const { return total_bytes_; }

    /// Finishes a received file.
    /// Throws Refusal(unprocessable) when `expected` is not empty and not the file's digest.
    static void check(IncomingFile& file, const std::string& expected);

    /// Makes a file a blob by renaming it; returns whether the blob is new. The caller has synced the file and checked
    /// its digest. A stored blob that was not verified since the start is replaced. A blob that a client sent once stays
    /// one that is never evicted.
    bool adopt(const std::filesystem::path& file, const std::string& digest, Origin origin);

    /// Opens a blob; verifies its digest the first time after the start.
    /// Throws Refusal(not_found).
    /// Throws Refusal(busy) for a file that cannot be read now; it is not forgotten.
    /// Throws LostBlob.
    OpenBlob open(const std::string& digest, const OnLoss& on_loss);

    /// Forgets a blob whose bytes do not have its digest.
    void lose(const std::string& digest, const OnLoss& on_loss);

    /// Removes rows and files, in one transaction.
    void remove(const std::vector<std::string>& digests);

    /// Notes that blobs were used; written to the database with flush_uses().
    void touch(const std::string& digest);
    void flush_uses();

private:
    bool is_verified(const std::string& digest);
    bool is_sent(const std::string& digest);
    void verify(const std::string& digest, int descriptor, const OnLoss& on_loss);
    [[noreturn]] static void refuse_for_now(const std::string& digest);
    [[noreturn]] void lose_if_missing(const std::string& digest, const OnLoss& on_loss);
    void forget(const std::vector<std::string>& digests, const OnLoss& on_loss = {});

    std::filesystem::path folder_;
    Database& database_;
    std::atomic<std::uint64_t> total_bytes_ = 0;  ///< of all rows; changed under database_.lock()
    std::mutex mutex_;                            ///< guards the members below
    std::unordered_set<std::string> verified_;
    std::unordered_map<std::string, double> used_;  ///< by digest: when
};

/// Seconds since 1970.
double now();

}  // namespace hairbake
