// Files named by the digest of their bytes.
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

#include "server/store/database.h"
#include "server/store/file_system.h"
#include "server/store/incoming_file.h"

namespace hairbake {

/// Whether `text` is 64 lower-case hexadecimal digits.
bool is_digest(const std::string& text);

/// Where a blob lies in the folder blobs: "ab/<sha256>".
std::string blob_name(const std::string& digest);

/// A blob turned out to be missing or of other bytes than its name says. The store has forgotten it already, and in the
/// same transaction was done what follows from that (BlobStore::OnLoss).
class LostBlob : public std::runtime_error {
public:
    explicit LostBlob(const std::string& digest)
        : std::runtime_error("the stored bytes of sha256:" + digest + " were lost or spoiled") {}
};

struct OpenBlob {
    Descriptor file;
    std::uint64_t bytes = 0;
};

/// `folder`/blobs/ab/<sha256>, `folder`/tmp and the table `blobs`. Thread-safe. How a blob becomes durable stands in
/// server/README.md.
class BlobStore {
public:
    /// What follows from the loss of a blob, in the transaction that forgets it.
    using OnLoss = std::function<void(Sql&)>;

    BlobStore(const std::filesystem::path& folder, Database& database);

    /// At boot, before anything else: empties tmp/, removes files without a row, and forgets rows without a whole file.
    /// Returns how many these were; what refers to them is Queue::recover()'s.
    std::size_t recover();

    std::filesystem::path incoming_folder() const { return folder_ / "tmp"; }
    std::filesystem::path path_of(const std::string& digest) const;

    /// Size in bytes, or nothing when there is no such blob.
    std::optional<std::uint64_t> size_of(const std::string& digest);
    std::uint64_t total_bytes() const { return total_bytes_; }

    /// Finishes a received file. Throws Refusal(unprocessable) when `expected` is not empty and another digest.
    static void check(IncomingFile& file, const std::string& expected);

    /// Takes over a file that is on the disk already (fsync done) and whose digest was checked. Returns whether the
    /// blob is new. It also takes the place of stored bytes that were not verified since the start.
    bool adopt(const std::filesystem::path& file, const std::string& digest);

    /// Opens a blob; checks its digest when it is the first time since the start. Throws Refusal(not_found), LostBlob,
    /// and Refusal(busy) for a file that cannot be read now, which is not forgotten.
    OpenBlob open(const std::string& digest, const OnLoss& on_loss);

    /// Forgets a blob whose bytes are not those of its name.
    void lose(const std::string& digest, const OnLoss& on_loss);

    /// Removes rows and files, in one transaction.
    void remove(const std::vector<std::string>& digests);

    /// Notes that blobs were used; written to the database with flush_uses().
    void touch(const std::string& digest);
    void flush_uses();

private:
    bool is_verified(const std::string& digest);
    void verify(const std::string& digest, int descriptor, const OnLoss& on_loss);
    [[noreturn]] static void refuse_for_now(const std::string& digest);
    [[noreturn]] void lose_if_missing(const std::string& digest, const OnLoss& on_loss);
    void forget(const std::vector<std::string>& digests, const OnLoss& on_loss = {});

    std::filesystem::path folder_;
    Database& database_;
    std::atomic<std::uint64_t> total_bytes_ = 0;  ///< what the table says, changed under database_.lock()
    std::mutex mutex_;                            ///< of what follows
    std::unordered_set<std::string> verified_;
    std::unordered_map<std::string, double> used_;  ///< when
};

/// Seconds since 1970.
double now();

}  // namespace hairbake
