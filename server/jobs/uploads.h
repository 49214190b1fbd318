// Uploads that go on after a lost connection (tus 1.0: core, creation, termination, expiration).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <set>
#include <span>
#include <string>

#include "server/store/blob_store.h"
#include "server/store/database.h"

namespace hairbake {

struct UploadState {
    std::string id, metadata;
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
        std::uint64_t budget = 0;      ///< of the store, and of all unfinished uploads together, as announced
        int most_open = 0;             ///< unfinished uploads of one token
    };
    Uploads(Database& database, BlobStore& store, std::filesystem::path folder, const Limits& limits);

    /// At boot: files without a row go, and rows whose file has become a blob already.
    void recover();
    /// Removes what has expired.
    void expire();

    /// Throws Refusal when create() would: (too_many) when that token has too many unfinished uploads, or with others
    /// of its own would announce more than half of the budget, (full) when all of them together would pass the budget.
    void check(std::uint64_t bytes, const std::string& sha256, const std::string& token);
    /// `sha256` is what the whole file must have; `token` names who sends it. Throws Refusal as check() does.
    UploadState create(std::uint64_t bytes, const std::string& sha256, const std::string& metadata,
                       const std::string& token);
    UploadState get(const std::string& id);
    /// Appends what `read` gives to its receiver, makes it durable, and makes the whole a blob when it is complete
    /// (then the upload is gone and is_blob() is its digest). Throws Refusal(conflict) when `offset` is not the
    /// upload's, or another request is at it, and Refusal(full) when there is no room for the whole; what came before
    /// an interruption stays.
    struct Appended {
        std::uint64_t offset = 0;
        double expires = 0;
        std::string blob;  ///< digest, once complete
    };
    Appended append(const std::string& id, std::uint64_t offset, const std::function<void(const Receiver&)>& read);
    void remove(const std::string& id);

private:
    struct Busy;
    std::uint64_t size_on_disk(const std::string& id) const;
    double prolong(const std::string& id);
    Appended complete(const std::string& id);
    void make_blob(const std::string& id, const std::string& digest, std::uint64_t bytes);
    void complete_whole_ones();

    Database& database_;
    BlobStore& store_;
    std::filesystem::path folder_;
    const Limits limits_;
    std::mutex mutex_;
    std::set<std::string> busy_;
};

}  // namespace hairbake
