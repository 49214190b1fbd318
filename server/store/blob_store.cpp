#include "server/store/blob_store.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <system_error>
#include <unordered_map>

#include "core/base/assert.h"
#include "core/base/digest.h"
#include "core/base/error.h"
#include "server/store/database.h"
#include "server/store/refusal.h"

namespace hairbake {
namespace fs = std::filesystem;

bool is_digest(const std::string& text) {
    return text.size() == 64 && std::all_of(text.begin(), text.end(),
                                            [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
}

std::string blob_name(const std::string& digest) { return digest.substr(0, 2) + "/" + digest; }

double now() { return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count(); }

BlobStore::BlobStore(const fs::path& folder, Database& database) : folder_(folder), database_(database) {
    make_folder(folder_ / "blobs");
    make_folder(folder_ / "tmp");
    constexpr char digits[] = "0123456789abcdef";
    for (const char high : std::string(digits))
        for (const char low : std::string(digits)) make_folder(folder_ / "blobs" / std::string{high, low});
    sync_folder(folder_ / "blobs");
    sync_folder(folder_);
    database_.read([&](Sql& sql) {
        total_bytes_ = static_cast<std::uint64_t>(sql.rows("SELECT sum(bytes) FROM blobs").at(0).integer(0));
    });
}

fs::path BlobStore::path_of(const std::string& digest) const {
    HAIRBAKE_ASSERT(is_digest(digest));
    return folder_ / "blobs" / blob_name(digest);
}

std::size_t BlobStore::recover(const std::set<std::string>& spared) {
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_ / "tmp"))
        if (!spared.count(entry.path().filename().string())) fs::remove_all(entry, ignored);

    std::unordered_map<std::string, std::int64_t> rows;
    database_.read([&](Sql& sql) {
        for (const SqlRow& row : sql.rows("SELECT sha256, bytes FROM blobs")) rows[row.text(0)] = row.integer(1);
    });
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder_ / "blobs")) {
        if (entry.is_directory()) continue;
        const auto row = rows.find(entry.path().filename().string());
        if (row != rows.end() && static_cast<std::int64_t>(entry.file_size()) == row->second)
            rows.erase(row);  // as it should be
        else
            fs::remove(entry, ignored);
    }
    std::vector<std::string> lost;
    for (const auto& [digest, bytes] : rows) lost.push_back(digest);
    if (!lost.empty()) forget(lost);
    return lost.size();
}

std::optional<std::uint64_t> BlobStore::size_of(const std::string& digest) {
    std::optional<std::uint64_t> bytes;
    database_.read([&](Sql& sql) {
        const auto rows = sql.rows("SELECT bytes FROM blobs WHERE sha256 = ?", {digest});
        if (!rows.empty()) bytes = static_cast<std::uint64_t>(rows[0].integer(0));
    });
    return bytes;
}

void BlobStore::check(IncomingFile& file, const std::string& expected) {
    file.finish();
    if (!expected.empty() && file.digest() != expected)
        throw Refusal(Refused::unprocessable,
                      "the digest of the " + std::to_string(file.bytes()) + " bytes received is " + file.digest() +
                          "; allowed is " + expected,
                      "sha256");
}

bool BlobStore::adopt(const fs::path& file, const std::string& digest, Origin origin) {
    const auto held = database_.lock();
    const bool known = size_of(digest).has_value();
    // Stored bytes that were not verified since the start may be spoiled; those of `file` are good.
    if (!known || !is_verified(digest)) {
        const auto bytes = static_cast<std::int64_t>(fs::file_size(file));
        if (::rename(file.c_str(), path_of(digest).c_str()) != 0) throw_store_error(file, errno);
        sync_folder(path_of(digest).parent_path());
        database_.write([&](Sql& sql) {
            sql.run("INSERT OR IGNORE INTO blobs VALUES(?, ?, ?, ?)", {digest, bytes, now(), now()});
            if (origin == Origin::sent) sql.run("INSERT OR IGNORE INTO sent_blobs VALUES(?)", {digest});
        });
        if (!known) total_bytes_ += static_cast<std::uint64_t>(bytes);
        const std::lock_guard lock(mutex_);
        verified_.insert(digest);
    } else if (origin == Origin::sent && !is_sent(digest)) {  // a result that a client sends as an input
        database_.write([&](Sql& sql) { sql.run("INSERT OR IGNORE INTO sent_blobs VALUES(?)", {digest}); });
    }
    touch(digest);
    return !known;
}

bool BlobStore::is_sent(const std::string& digest) {
    bool sent = false;
    database_.read([&](Sql& sql) { sent = !sql.rows("SELECT 1 FROM sent_blobs WHERE sha256 = ?", {digest}).empty(); });
    return sent;
}

OpenBlob BlobStore::open(const std::string& digest, const OnLoss& on_loss) {
    if (!is_digest(digest) || !size_of(digest))
        throw Refusal(Refused::not_found, "there is no blob " + digest.substr(0, 64), "sha256");
    OpenBlob blob{Descriptor(::open(path_of(digest).c_str(), O_RDONLY | O_CLOEXEC)), 0};
    if (!blob.file && errno == ENOENT) lose_if_missing(digest, on_loss);
    struct stat facts {};
    if (!blob.file || ::fstat(blob.file.get(), &facts) != 0 || !S_ISREG(facts.st_mode)) refuse_for_now(digest);
    blob.bytes = static_cast<std::uint64_t>(facts.st_size);
    verify(digest, blob.file.get(), on_loss);
    touch(digest);
    return blob;
}

/// The reason why the file cannot be read may pass, so nothing is forgotten.
void BlobStore::refuse_for_now(const std::string& digest) {
    throw Refusal(Refused::busy, "the stored bytes of sha256:" + digest + " cannot be read now");
}

void BlobStore::lose_if_missing(const std::string& digest, const OnLoss& on_loss) {
    const auto held = database_.lock();  // it may have been removed and sent again meanwhile
    if (fs::exists(path_of(digest)) || !size_of(digest)) refuse_for_now(digest);
    lose(digest, on_loss);
    throw LostBlob(digest);
}

bool BlobStore::is_verified(const std::string& digest) {
    const std::lock_guard lock(mutex_);
    return verified_.count(digest) > 0;
}

void BlobStore::verify(const std::string& digest, int descriptor, const OnLoss& on_loss) {
    if (is_verified(digest)) return;
    Digest found;
    std::vector<std::byte> piece(1 << 18);
    ssize_t count = 0;
    for (off_t at = 0; (count = ::pread(descriptor, piece.data(), piece.size(), at)) > 0; at += count)
        found.add(std::span(piece).first(static_cast<std::size_t>(count)));
    if (count < 0) refuse_for_now(digest);
    if (found.hex() != digest) {
        const auto held = database_.lock();
        if (is_verified(digest)) refuse_for_now(digest);  // replaced by good bytes meanwhile
        lose(digest, on_loss);
        throw LostBlob(digest);
    }
    const std::lock_guard lock(mutex_);
    verified_.insert(digest);
}

void BlobStore::lose(const std::string& digest, const OnLoss& on_loss) {
    const auto held = database_.lock();
    forget({digest}, on_loss);
    ::unlink(path_of(digest).c_str());
}

void BlobStore::remove(const std::vector<std::string>& digests) {
    const auto held = database_.lock();
    forget(digests);
    for (const std::string& digest : digests) ::unlink(path_of(digest).c_str());
}

void BlobStore::forget(const std::vector<std::string>& digests, const OnLoss& on_loss) {
    const auto held = database_.lock();
    std::int64_t bytes = 0;
    database_.write([&](Sql& sql) {
        for (const std::string& digest : digests)
            for (const SqlRow& row : sql.rows("DELETE FROM blobs WHERE sha256 = ? RETURNING bytes", {digest}))
                bytes += row.integer(0);
        if (on_loss) on_loss(sql);
    });
    total_bytes_ -= static_cast<std::uint64_t>(bytes);
    const std::lock_guard lock(mutex_);
    for (const std::string& digest : digests) {
        verified_.erase(digest);
        used_.erase(digest);
    }
}

void BlobStore::touch(const std::string& digest) {
    const std::lock_guard lock(mutex_);
    used_[digest] = now();
}

void BlobStore::flush_uses() {
    std::unordered_map<std::string, double> used;
    {
        const std::lock_guard lock(mutex_);
        used.swap(used_);
    }
    if (used.empty()) return;
    database_.write([&](Sql& sql) {
        for (const auto& [digest, time] : used) sql.run("UPDATE blobs SET used = ? WHERE sha256 = ?", {time, digest});
    });
}

}  // namespace hairbake
