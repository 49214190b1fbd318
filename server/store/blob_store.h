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
#include <string_view>
#include <unordered_map>
#include <vector>

#include "server/store/file_system.h"
#include "server/store/incoming_file.h"
#include "server/store/lost_found.h"
#include "server/store/pinned_files.h"

namespace hairbake {

class Database;
class Sql;

/// Whether `text` is 64 lower-case hexadecimal digits.
bool is_digest(const std::string& text);

/// The digest without the prefix "sha256:", with which it may be written.
std::string without_prefix(const std::string& digest);

/// Path of a blob in the folder blobs: "ab/<sha256>".
std::string blob_name(const std::string& digest);

/// A blob is missing, or its bytes do not have its digest. The store has already forgotten it and called OnLoss, both
/// in one transaction.
class LostBlob : public std::runtime_error {
public:
    /// `comes_back`: a stage wrote it, which is baked again.
    LostBlob(const std::string& message, bool comes_back) : std::runtime_error(message), comes_back_(comes_back) {}

    /// False for an input, which must be sent again, and for a thumbnail.
    bool comes_back() const { return comes_back_; }

private:
    bool comes_back_;
};

/// Where a blob's bytes come from: a client sent them, or a worker made them.
enum class Origin { sent, made };

struct OpenBlob {
    Descriptor file;
    std::uint64_t bytes = 0;
};

/// What the file system says of a file. Every change of its bytes changes ctime.
struct FileFacts {
    std::int64_t bytes = 0, mtime_ns = 0, ctime_ns = 0;  ///< nanoseconds since 1970
    bool operator==(const FileFacts&) const = default;
};

/// Nothing when there is no regular file or it cannot be looked at.
std::optional<FileFacts> facts_of(const std::filesystem::path& file);
std::optional<FileFacts> facts_of(int descriptor);

/// Blobs that a start found missing.
struct LostBlobs {
    std::size_t results = 0;          ///< and other blobs that no client sent
    std::vector<std::string> inputs;  ///< as input_text() names them: they must be sent again
};

/// `folder`/blobs/ab/<sha256>, `folder`/tmp and the table `blobs`. Thread-safe. docs/architecture.md tells how a blob
/// becomes durable.
class BlobStore {
public:
    /// Called in the transaction that forgets a lost blob, to update the rows that refer to it.
    using OnLoss = std::function<void(Sql&)>;

    BlobStore(const std::filesystem::path& folder, Database& database);

    /// At boot, before anything else. The caller has made sure that folder and database belong together.
    ///
    /// Removes the bodies and work folders in tmp/ but those in `spared`, and files of blobs whose removal was
    /// committed.
    /// Moves other files without a row, files of another size, and what is no file to lost+found. Forgets rows without
    /// a whole file and returns them; Queue::recover() updates what refers to them.
    /// Throws Error(bad_input), and changes nothing, when no blob has a file and not `may_miss_all`.
    LostBlobs recover(const std::set<std::string>& spared = {}, bool may_miss_all = false);

    std::filesystem::path incoming_folder() const { return folder_ / "tmp"; }
    std::filesystem::path path_of(const std::string& digest) const;

    /// Size in bytes, or nothing when there is no such blob.
    std::optional<std::uint64_t> size_of(const std::string& digest);
    std::uint64_t total_bytes() const { return total_bytes_; }

    /// Throws Refusal(busy), naming the folder and what to do, when a folder of blobs is another one than at the start.
    void check_folders() const;

    /// Finishes a received file.
    /// Throws Refusal(unprocessable) when `expected` is not empty and not the file's digest.
    static void check(IncomingFile& file, const std::string& expected);

    /// Makes a file a blob by renaming it; returns whether the blob is new. The caller has synced the file and checked
    /// its digest. A stored blob whose present bytes were not verified since the start is replaced. A blob that a
    /// client sent once stays one that is never evicted.
    bool adopt(const std::filesystem::path& file, const std::string& digest, Origin origin);

    /// A client has sent the bytes of a stored blob: it is used now, and never evicted.
    void note_sent(const std::string& digest);

    /// After a second link to a blob's file was unlinked: that changed the file's ctime, and not its bytes.
    void note_other_link_removed(const std::string& digest);

    /// Opens a blob; verifies its digest the first time after the start, and when size, mtime or ctime of the file have
    /// changed since.
    /// Throws Refusal(not_found).
    /// Throws Refusal(busy) for a file that cannot be read now, or whose folder was moved or replaced since the start;
    /// it is not forgotten.
    /// Throws LostBlob.
    OpenBlob open(const std::string& digest, const OnLoss& on_loss);

    /// Forgets a blob whose bytes do not have its digest, and moves what is in its place to lost+found. Returns the
    /// exception for the caller to throw.
    /// Throws Refusal(busy), and forgets nothing, when its folder was moved or replaced since the start.
    LostBlob lose(const std::string& digest, const OnLoss& on_loss);

    /// At most `most` blobs whose digest was last checked before `time` (seconds since 1970), longest ago first.
    std::vector<std::string> unchecked_since(double time, int most);

    /// Reads a blob from the disk and compares its digest. `pace` is called with the number of bytes after each piece
    /// and may throw to end the check. Nothing happens when there is no such blob any more.
    /// Throws as open().
    void check_digest(const std::string& digest, const OnLoss& on_loss, const std::function<void(std::size_t)>& pace);

    /// What keeps this process from reading the first of the files that it may not read, and what to do; empty when it
    /// may read all. As ". This program may not use FILE ...", to follow a message.
    std::string advice_for_closed(const std::vector<std::string>& digests) const;

    /// Puts off the next check of a blob that could not be read.
    void note_check_failed(const std::string& digest);

    /// Throws Refusal when the file of a blob cannot be removed now.
    void require_removable(const std::string& digest) const;

    /// Removes rows and files, in one transaction. `reason` is for the log.
    /// Throws DeletionNeedsRoom, and changes nothing, when the disk is full.
    void remove(const std::vector<std::string>& digests, std::string_view reason);
    /// The same for the blobs that `choose` names; it may change other rows in the same transaction.
    using Choice = std::function<std::vector<std::string>(Sql&)>;
    void remove(const Choice& choose, std::string_view reason);

    /// Moves a file of the store to lost+found and adds it to `count`.
    void put_aside(const std::filesystem::path& file, FileCount& count);
    /// Says how much lost+found holds. Call it after the start has moved its last file there.
    void log_lost_found() const;
    std::filesystem::path lost_folder() const { return lost_found_.folder(); }

    /// Notes that blobs were used; written to the database with flush_uses(), as are checks of digests.
    void touch(const std::string& digest);
    void flush_uses();

private:
    /// The folder of a blob is the one of the start.
    /// Throws Refusal(busy) when not.
    void check_folder_of(const std::string& digest) const;
    LostBlobs forget_missing(const std::vector<std::string>& digests);
    void sweep_incoming(const std::set<std::string>& spared);
    void clear_unknown_files(const std::vector<std::filesystem::path>& files);
    bool is_verified(const std::string& digest, const FileFacts& facts);
    bool is_sent(const std::string& digest);
    void verify(const std::string& digest, int descriptor, const OnLoss& on_loss,
                const std::function<void(std::size_t)>& pace = {});
    void note_verified(const std::string& digest, const FileFacts& facts);
    [[noreturn]] void refuse_for_now(const std::string& digest, int error = 0) const;
    Descriptor open_blob_file(const std::string& digest, const OnLoss& on_loss);
    [[noreturn]] void lose_without_file(const std::string& digest, const OnLoss& on_loss);
    void clear_place(const std::filesystem::path& path);
    std::vector<std::string> forget(const Choice& choose, const OnLoss& in_transaction = {});

    std::filesystem::path folder_;
    Database& database_;
    std::vector<PinnedFiles> folders_;            ///< blobs/00 to blobs/ff
    std::atomic<std::uint64_t> total_bytes_ = 0;  ///< of all rows; changed under database_.lock()
    std::mutex mutex_;                            ///< guards the members below
    /// What a file was like when its digest was right, and when that was.
    struct Check {
        double time = 0;
        FileFacts facts;
    };
    std::unordered_map<std::string, Check> verified_;  ///< by digest; since the start
    std::unordered_map<std::string, Check> checked_;   ///< that flush_uses() has yet to write
    std::unordered_map<std::string, double> used_;     ///< by digest: when
    LostFound lost_found_;                             ///< guarded by database_.lock()
};

/// Seconds since 1970.
double now();

}  // namespace hairbake
