#include "server/store/blob_store.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>

#include "core/base/assert.h"
#include "core/base/short_text.h"
#include "server/store/database.h"
#include "server/store/disk_reserve.h"
#include "server/store/input_text.h"
#include "server/store/refusal.h"

namespace hairbake {
namespace fs = std::filesystem;

bool is_digest(const std::string& text) {
    return text.size() == 64 && std::all_of(text.begin(), text.end(),
                                            [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
}

std::string without_prefix(const std::string& digest) {
    return digest.starts_with("sha256:") ? digest.substr(7) : digest;
}

std::string blob_name(const std::string& digest) { return digest.substr(0, 2) + "/" + digest; }

namespace {

FileFacts read_facts(const struct stat& facts) {
    const auto nanoseconds = [](const timespec& time) {
        return time.tv_sec * std::int64_t(1'000'000'000) + time.tv_nsec;
    };
    return {facts.st_size, nanoseconds(facts.st_mtim), nanoseconds(facts.st_ctim)};
}

constexpr const char* advice_for_folder =
    "Put the folder back that was there before, or unmount what covers it. To use what is there now, restart the "
    "daemon: it then forgets the files that are missing";

/// Whether this process may add files to the folder and remove some.
bool may_write(const fs::path& folder) { return ::faccessat(AT_FDCWD, folder.c_str(), W_OK | X_OK, AT_EACCESS) == 0; }

}  // namespace

std::optional<FileFacts> facts_of(const fs::path& file) {
    struct stat facts {};
    if (::stat(file.c_str(), &facts) != 0 || !S_ISREG(facts.st_mode)) return std::nullopt;
    return read_facts(facts);
}

std::optional<FileFacts> facts_of(int descriptor) {
    struct stat facts {};
    if (::fstat(descriptor, &facts) != 0 || !S_ISREG(facts.st_mode)) return std::nullopt;
    return read_facts(facts);
}

double now() { return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count(); }

BlobStore::BlobStore(const fs::path& folder, Database& database)
    : folder_(folder), database_(database), lost_found_(folder) {
    make_folder(folder_ / "blobs");
    make_folder(folder_ / "tmp");
    constexpr char digits[] = "0123456789abcdef";
    for (const char high : std::string(digits))
        for (const char low : std::string(digits)) {
            const fs::path part = folder_ / "blobs" / std::string{high, low};
            make_folder(part);
            folders_.emplace_back(std::vector<PinnedFiles::Path>{{part, advice_for_folder}});
        }
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

void BlobStore::check_folder_of(const std::string& digest) const {
    HAIRBAKE_ASSERT(is_digest(digest));
    folders_.at(std::stoul(digest.substr(0, 2), nullptr, 16)).check();
}

void BlobStore::check_folders() const {
    for (const PinnedFiles& folder : folders_) folder.check();
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
    database_.check_in_place();
    check_folder_of(digest);
    const bool known = size_of(digest).has_value();
    const fs::path path = path_of(digest);
    const std::optional<FileFacts> stored = known ? facts_of(path) : std::nullopt;
    // Stored bytes that were not verified since the start may be spoiled; those of `file` are good.
    if (!stored || !is_verified(digest, *stored)) {
        clear_place(path);
        if (::rename(file.c_str(), path.c_str()) != 0)
            throw_store_error(may_write(file.parent_path()) ? path : file, errno);
        sync_folder(path.parent_path());
        const FileFacts facts = facts_of(path).value_or(FileFacts{});
        database_.write([&](Sql& sql) {
            sql.run(
                "INSERT INTO blobs(sha256, bytes, created, used, mtime_ns, ctime_ns, checked) VALUES(?, ?, ?, ?, ?, ?, "
                "?) ON CONFLICT(sha256) DO UPDATE SET mtime_ns = excluded.mtime_ns, ctime_ns = excluded.ctime_ns, "
                "checked = excluded.checked",
                {digest, facts.bytes, now(), now(), facts.mtime_ns, facts.ctime_ns, now()});
            sql.run("DELETE FROM removals WHERE sha256 = ?", {digest});
            if (origin == Origin::sent) sql.run("INSERT OR IGNORE INTO sent_blobs VALUES(?)", {digest});
        });
        if (!known) total_bytes_ += static_cast<std::uint64_t>(facts.bytes);
        const std::lock_guard lock(mutex_);
        verified_[digest] = {now(), facts};
    } else if (origin == Origin::sent) {
        note_sent(digest);
    }
    touch(digest);
    return !known;
}

/// Writes for a result alone, which a client sends as an input.
void BlobStore::note_sent(const std::string& digest) {
    if (!is_sent(digest))
        database_.write([&](Sql& sql) { sql.run("INSERT OR IGNORE INTO sent_blobs VALUES(?)", {digest}); });
    touch(digest);
}

bool BlobStore::is_sent(const std::string& digest) {
    bool sent = false;
    database_.read([&](Sql& sql) { sent = !sql.rows("SELECT 1 FROM sent_blobs WHERE sha256 = ?", {digest}).empty(); });
    return sent;
}

OpenBlob BlobStore::open(const std::string& digest, const OnLoss& on_loss) {
    if (!is_digest(digest) || !size_of(digest))
        throw Refusal(Refused::not_found, "there is no blob " + shortened(digest, 64), "sha256");
    OpenBlob blob{open_blob_file(digest, on_loss), 0};
    const std::optional<FileFacts> facts = facts_of(blob.file.get());
    if (!facts) refuse_for_now(digest);
    blob.bytes = static_cast<std::uint64_t>(facts->bytes);
    verify(digest, blob.file.get(), on_loss);
    touch(digest);
    return blob;
}

namespace {

LostBlob describe_loss(Sql& sql, const std::string& digest) {
    const std::string lost = "the stored bytes of sha256:" + digest + " were lost or spoiled";
    if (!sql.rows("SELECT 1 FROM stage_files WHERE sha256 = ? LIMIT 1", {digest}).empty())
        return {lost + "; the result is baked again", true};
    if (const auto input = input_text(sql, digest)) return {lost + ": send " + *input + " again", false};
    return {lost, false};
}

}  // namespace

LostBlob BlobStore::lose(const std::string& digest, const OnLoss& on_loss) {
    const auto held = database_.lock();
    check_folder_of(digest);  // another folder hides more files than this one: they are not lost
    std::optional<LostBlob> lost;
    database_.read([&](Sql& sql) { lost = describe_loss(sql, digest); });  // its rows are gone afterwards
    const fs::path path = path_of(digest);
    const std::string found = words_for_path(path);
    forget([&](Sql&) { return std::vector{digest}; }, on_loss);
    FileCount moved;
    if (found != "nothing") put_aside(path, moved);
    log_move(moved, lost_folder(),
             found == "a file" ? "the bytes of blob " + digest + " do not have its digest"
                               : found + " was in the place of blob " + digest);
    return *lost;
}

void BlobStore::remove(const std::vector<std::string>& digests, std::string_view reason) {
    remove([&](Sql&) { return digests; }, reason);
}

void BlobStore::require_removable(const std::string& digest) const {
    check_folder_of(digest);
    hairbake::require_removable(path_of(digest));
}

/// The rows in `removals` tell the next start that these files may go, should this process die before all are gone.
void BlobStore::remove(const Choice& choose, std::string_view reason) {
    const auto held = database_.lock();
    std::vector<std::string> digests;
    try {
        forget([&](Sql& sql) {
            digests.clear();
            digests = choose(sql);
            for (const std::string& digest : digests) {
                require_removable(digest);
                sql.run("INSERT OR REPLACE INTO removals VALUES(?, ?)", {digest, now()});
            }
            return digests;
        });
    } catch (const Error& error) {
        if (error.system_error() != ENOSPC) throw;
        std::vector<fs::path> files;
        for (const std::string& digest : digests) files.push_back(path_of(digest));
        throw DeletionNeedsRoom(error, std::move(files));
    }
    FileCount removed;
    for (const std::string& digest : digests) {
        clear_place(path_of(digest));
        remove_counted(path_of(digest), removed);
    }
    log_removal(removed, reason);
}

void BlobStore::put_aside(const fs::path& file, FileCount& count) {
    const auto held = database_.lock();
    lost_found_.take(file, count);
}

/// Moves a folder, a pipe or a device away that is in the place of a blob's file.
void BlobStore::clear_place(const fs::path& path) {
    const PathKind kind = kind_of_path(path);
    if (kind != PathKind::folder && kind != PathKind::other) return;
    const std::string found = words_for_path(path);
    FileCount moved;
    put_aside(path, moved);
    log_move(moved, lost_folder(), found + " was in the place of blob " + path.filename().string());
}

/// Forgets the blobs that `choose` names, in one transaction; returns them.
std::vector<std::string> BlobStore::forget(const Choice& choose, const OnLoss& in_transaction) {
    const auto held = database_.lock();
    std::vector<std::string> digests;
    std::int64_t bytes = 0;
    database_.write([&](Sql& sql) {
        digests = choose(sql);
        for (const std::string& digest : digests)
            for (const SqlRow& row : sql.rows("DELETE FROM blobs WHERE sha256 = ? RETURNING bytes", {digest}))
                bytes += row.integer(0);
        if (in_transaction) in_transaction(sql);
    });
    total_bytes_ -= static_cast<std::uint64_t>(bytes);
    const std::lock_guard lock(mutex_);
    for (const std::string& digest : digests) {
        verified_.erase(digest);
        checked_.erase(digest);
        used_.erase(digest);
    }
    return digests;
}

void BlobStore::touch(const std::string& digest) {
    const std::lock_guard lock(mutex_);
    used_[digest] = now();
}

void BlobStore::flush_uses() {
    std::unordered_map<std::string, double> used;
    std::unordered_map<std::string, Check> checked;
    {
        const std::lock_guard lock(mutex_);
        used.swap(used_);
        checked.swap(checked_);
    }
    constexpr double minute = 60;  // longer than a file system takes to make the removal of a file durable
    bool are_old = false;          // removals that the next start need not know
    database_.read([&](Sql& sql) {
        are_old = !sql.rows("SELECT 1 FROM removals WHERE time < ? LIMIT 1", {now() - minute}).empty();
    });
    if (used.empty() && checked.empty() && !are_old) return;
    database_.write([&](Sql& sql) {
        for (const auto& [digest, time] : used) sql.run("UPDATE blobs SET used = ? WHERE sha256 = ?", {time, digest});
        for (const auto& [digest, check] : checked)
            sql.run("UPDATE blobs SET checked = ?, mtime_ns = ?, ctime_ns = ? WHERE sha256 = ?",
                    {check.time, check.facts.mtime_ns, check.facts.ctime_ns, digest});
        sql.run("DELETE FROM removals WHERE time < ?", {now() - minute});
    });
}

}  // namespace hairbake
