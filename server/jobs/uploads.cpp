#include "server/jobs/uploads.h"

#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>

#include "core/base/digest.h"
#include "core/base/short_text.h"
#include "server/store/blob_store.h"
#include "server/store/database.h"
#include "server/store/disk_reserve.h"
#include "server/store/file_system.h"
#include "server/store/refusal.h"
#include "server/store/removal_log.h"
#include "server/store/room.h"
#include "server/store/store_advice.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

constexpr double longest_retry_s = 60;

[[noreturn]] void refuse_unknown(const std::string& upload) {
    throw Refusal(Refused::not_found, "there is no upload " + shortened(upload, 64));
}

/// A folder that is missing with the file hides other uploads, too: it may come back.
[[noreturn]] void refuse_lost(const fs::path& folder, const std::string& upload) {
    if (kind_of_path(folder) != PathKind::folder)
        throw Refusal(Refused::busy, "the uploads cannot be read now: " + folder.string() + " is missing. " +
                                         advice_for(folder, ENOENT));
    throw Refusal(Refused::not_found,
                  "the bytes of the upload " + shortened(upload, 64) + " were lost: begin a new upload of the file");
}

}  // namespace

/// Marks an upload as being written.
struct Uploads::Busy {
    Busy(Uploads& uploads, const std::string& id) : uploads_(uploads), id_(id) {
        const std::lock_guard lock(uploads.mutex_);
        if (!uploads.busy_.insert(id).second)
            throw Refusal(Refused::conflict, "another request is writing to this upload");
    }
    ~Busy() {
        const std::lock_guard lock(uploads_.mutex_);
        uploads_.busy_.erase(id_);
    }
    Busy(const Busy&) = delete;
    Busy& operator=(const Busy&) = delete;

private:
    Uploads& uploads_;
    const std::string id_;
};

/// The room of the bytes that an upload receives. At the end, however it comes, the bytes on the disk are kept.
struct Uploads::Growth {
    Growth(Uploads& of, const std::string& upload, Room::Share reserved)
        : uploads(of), id(upload), share(std::move(reserved)) {}
    ~Growth() { share.become_kept(id, uploads.size_on_disk(id)); }
    Growth(const Growth&) = delete;
    Growth& operator=(const Growth&) = delete;

    Uploads& uploads;
    const std::string id;
    Room::Share share;
};

Uploads::Uploads(Database& database, BlobStore& store, Room& room, DiskReserve& reserve, fs::path folder,
                 const Limits& limits)
    : database_(database), store_(store), room_(room), reserve_(reserve), folder_(std::move(folder)), limits_(limits) {
    make_folder(folder_);
}

/// For the budget: 0 when there is no file, or it cannot be looked at.
std::uint64_t Uploads::size_on_disk(const std::string& id) const {
    std::error_code error;
    const std::uintmax_t bytes = fs::file_size(folder_ / id, error);
    return error ? 0 : bytes;
}

/// Throws Refusal(not_found) when there is no file.
/// Throws as throw_store_error() when it cannot be looked at.
std::uint64_t Uploads::offset_of(const std::string& id) const {
    struct stat facts {};
    const int error = ::stat((folder_ / id).c_str(), &facts) == 0 ? 0 : errno;
    if (error == 0 && S_ISREG(facts.st_mode)) return static_cast<std::uint64_t>(facts.st_size);
    if (error != 0 && kind_of_path(folder_ / id) == PathKind::unknown) throw_store_error(folder_ / id, error);
    refuse_lost(folder_, id);
}

/// Whether the file is a second link to the file of a blob: a crash came after the upload had become one.
bool Uploads::is_blob_file(const fs::path& file) const try {
    if (fs::hard_link_count(file) < 2) return false;
    const std::string digest = digest_of_file(file);
    return store_.size_of(digest) && fs::equivalent(file, store_.path_of(digest));
} catch (const std::exception&) {  // it cannot be read
    return false;
}

/// Removes or moves away what is in the folder and has no row. What is no file has no place there, with a row or not.
void Uploads::clear_unknown() {
    FileCount unknown, empty, doubled;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
        bool known = false;
        database_.read([&](Sql& sql) {
            known = !sql.rows("SELECT 1 FROM uploads WHERE id = ?", {entry.path().filename().string()}).empty();
        });
        const bool is_file = entry.symlink_status().type() == fs::file_type::regular;
        if (known && is_file) continue;
        std::error_code error;
        if (is_file && entry.file_size(error) == 0)
            remove_counted(entry.path(), empty);
        else if (is_file && is_blob_file(entry.path()))
            remove_counted(entry.path(), doubled);
        else
            store_.put_aside(entry.path(), unknown);
    }
    log_removal(empty, "empty uploads that the database does not know");
    log_removal(doubled, "uploads that had become blobs, which keep the bytes");
    log_move(unknown, store_.lost_folder(), "the database does not know these uploads, or they are no files");
}

void Uploads::recover() {
    clear_unknown();
    database_.write([&](Sql& sql) {
        for (const SqlRow& row : sql.rows("SELECT id FROM uploads"))
            if (kind_of_path(folder_ / row.text(0)) == PathKind::nothing)
                sql.run("DELETE FROM uploads WHERE id = ?", {row.text(0)});
    });
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_))
        if (entry.is_regular_file()) room_.keep(entry.path().filename().string(), entry.file_size());
    expire();
    complete_whole_ones();
}

/// A crash can come between an upload's last byte and its blob, and the client may not ask again. An upload that cannot
/// become a blob now (the disk is full) stays: an empty PATCH tries again. The service starts all the same.
void Uploads::complete_whole_ones() {
    std::vector<std::string> whole;
    database_.read([&](Sql& sql) {
        for (const SqlRow& row : sql.rows("SELECT id, bytes FROM uploads"))
            if (size_on_disk(row.text(0)) == static_cast<std::uint64_t>(row.integer(1))) whole.push_back(row.text(0));
    });
    for (const std::string& id : whole) try {
            complete(id);
        } catch (const std::exception& error) {  // no room, or the digest is wrong: then the upload is gone
            spdlog::warn("the whole upload {} did not become a blob: {}", id, error_text(error));
        }
}

void Uploads::expire() {
    std::vector<std::string> old;
    database_.read([&](Sql& sql) {
        for (const SqlRow& row : sql.rows("SELECT id FROM uploads WHERE expires < ?", {now()}))
            old.push_back(row.text(0));
    });
    for (const std::string& id : old) try {
            remove(id, "the upload expired");
        } catch (const std::exception& error) {  // a request writes to it, or the disk is full
            spdlog::warn("the expired upload {} stays: {}", id, error_text(error));
        }
}

/// Not exact: requests at the same time may pass the limits by a few uploads.
void Uploads::check(std::uint64_t bytes, const std::string& sha256, const std::string& token) {
    if (bytes > limits_.most_bytes)
        throw Refusal(Refused::too_large, "Upload-Length is " + std::to_string(bytes) + "; allowed is up to " +
                                              std::to_string(limits_.most_bytes) + " bytes");
    if (!is_digest(sha256))
        throw Refusal(Refused::malformed,
                      "Upload-Metadata lacks sha256: the digest of the whole file as 64 hexadecimal digits",
                      "Upload-Metadata");
    std::int64_t open = 0;
    double first_end = 0;
    std::uint64_t own = 0, all = 0;
    database_.read([&](Sql& sql) {
        const auto mine =
            sql.rows("SELECT count(*), sum(bytes), min(expires) FROM uploads WHERE token = ?", {token}).at(0);
        open = mine.integer(0);
        first_end = mine.number(2);
        own = static_cast<std::uint64_t>(mine.integer(1));
        all = static_cast<std::uint64_t>(sql.rows("SELECT sum(bytes) FROM uploads").at(0).integer(0));
    });
    const auto refuse = [&](Refused why, const std::string& found, std::uint64_t allowed, const std::string& unit) {
        // Any of them may end at any time, and the first one ends by itself then.
        const int wait = static_cast<int>(std::clamp(std::ceil(first_end - now()), 1.0, longest_retry_s));
        const std::string when =
            why == Refused::too_many ? ", and try again in " + std::to_string(wait) + " s" : std::string();
        throw Refusal(why, found + "; allowed are " + std::to_string(allowed) + unit + ": finish some or delete them" +
                               when + "; one that receives nothing for " +
                               std::to_string(static_cast<std::int64_t>(limits_.lifetime_s)) + " s ends by itself")
            .retry_after(wait);
    };
    if (open >= limits_.most_open)
        refuse(Refused::too_many, "there are " + std::to_string(open) + " unfinished uploads of this token",
               static_cast<std::uint64_t>(limits_.most_open), "");
    const std::uint64_t share = limits_.budget / 2;  // so that one token cannot block all others
    if (open > 0 && own + bytes > share)
        refuse(Refused::too_many, "with this one, unfinished uploads of this token have " + std::to_string(own + bytes),
               share, " bytes, half of the store's budget");
    if (all + bytes > limits_.budget)
        refuse(Refused::full, "with this one, unfinished uploads have " + std::to_string(all + bytes), limits_.budget,
               " bytes, the store's budget");
}

UploadState Uploads::create(std::uint64_t bytes, const std::string& sha256, const std::string& metadata,
                            const std::string& token) {
    check(bytes, sha256, token);
    database_.check_in_place();
    room_.reserve(bytes, store_.size_of(sha256).has_value());  // for this moment: refused if it cannot fit
    UploadState state{random_name(), metadata, sha256, bytes, 0, now() + limits_.lifetime_s};
    const Descriptor file(::open((folder_ / state.id).c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0640));
    if (!file) throw_store_error(folder_ / state.id, errno);
    sync_folder(folder_);
    database_.write([&](Sql& sql) {
        sql.run("INSERT INTO uploads VALUES(?, ?, ?, ?, ?, ?, ?)",
                {state.id, static_cast<std::int64_t>(bytes), sha256, metadata, now(), state.expires, token});
    });
    return state;
}

UploadState Uploads::get(const std::string& id) {
    UploadState state;
    database_.read([&](Sql& sql) {
        const auto rows = sql.rows("SELECT bytes, metadata, expires, sha256 FROM uploads WHERE id = ?", {id});
        if (rows.empty()) refuse_unknown(id);
        const auto bytes = static_cast<std::uint64_t>(rows[0].integer(0));
        state = {id, rows[0].text(1), rows[0].text(3), bytes, 0, rows[0].number(2)};
    });
    state.offset = offset_of(id);
    return state;
}

Uploads::Appended Uploads::append(const std::string& id, std::uint64_t offset, std::optional<std::uint64_t> length,
                                  const std::function<void(const Receiver&)>& read) {
    const Busy busy(*this, id);
    database_.check_in_place();
    const UploadState state = get(id);
    if (offset != state.offset)
        throw Refusal(Refused::conflict,
                      "Upload-Offset is " + std::to_string(offset) + "; allowed is " + std::to_string(state.offset),
                      "Upload-Offset");
    try {
        receive(state, length, read);
    } catch (const Refusal& refusal) {
        if (refusal.why() == Refused::full || refusal.why() == Refused::busy)
            prolong(id);  // what was acknowledged waits for room
        throw;
    }
    const std::uint64_t size = offset_of(id);
    if (size == state.bytes) return complete(id);
    return {size, prolong(id), {}};
}

/// Appends the body to the upload's file and syncs it.
void Uploads::receive(const UploadState& state, std::optional<std::uint64_t> length,
                      const std::function<void(const Receiver&)>& read) {
    const auto refuse_if_longer = [&](std::uint64_t bytes, std::uint64_t left) {
        if (bytes > left)
            throw Refusal(Refused::too_large,
                          "the upload grows beyond its Upload-Length of " + std::to_string(state.bytes));
    };
    std::uint64_t left = state.bytes - state.offset;
    refuse_if_longer(length.value_or(0), left);
    const fs::path path = folder_ / state.id;
    const OpenedFile opened = open_file(path, O_WRONLY | O_APPEND);
    if (!opened.file && (opened.kind == PathKind::file || opened.kind == PathKind::unknown))
        throw_store_error(path, opened.error);
    if (!opened.file) refuse_lost(folder_, state.id);
    const int file = opened.file.get();
    Growth growth(*this, state.id, room_.reserve(length, store_.size_of(state.sha256).has_value()));
    read([&](std::span<const std::byte> bytes) {
        refuse_if_longer(bytes.size(), left);
        growth.share.grow(bytes.size());
        write_all(file, bytes, path);
        left -= bytes.size();
    });
    sync_file(file, path);
}

double Uploads::prolong(const std::string& id) {
    const double expires = now() + limits_.lifetime_s;
    database_.write([&](Sql& sql) { sql.run("UPDATE uploads SET expires = ? WHERE id = ?", {expires, id}); });
    return expires;
}

Uploads::Appended Uploads::complete(const std::string& id) {
    const UploadState state = get(id);
    const std::string found = digest_of_file(folder_ / id);
    const bool whole = found == state.sha256;
    if (whole) make_blob(id, found);
    forget(id, whole ? "the upload became a blob, which keeps the bytes" : "the upload's digest is wrong");
    if (whole) store_.note_other_link_removed(found);
    if (!whole)
        throw Refusal(Refused::unprocessable,
                      "the digest of the uploaded bytes is " + found + "; allowed is " + state.sha256, "sha256");
    return {state.bytes, 0, state.sha256};
}

/// The bytes are on the disk and counted already, so the blob needs no room. If it cannot be made (the disk is broken),
/// the whole upload stays, and an empty PATCH tries again.
void Uploads::make_blob(const std::string& id, const std::string& digest) {
    const auto held = database_.lock();
    // By a second link: a crash before the row is written leaves the upload as it was.
    struct Link {
        fs::path path;
        ~Link() { ::unlink(path.c_str()); }  // there is none when the store took it
    } const second{store_.incoming_folder() / random_name()};
    if (::link((folder_ / id).c_str(), second.path.c_str()) != 0) throw_store_error(second.path, errno);
    store_.adopt(second.path, digest, Origin::sent);
    room_.keep(id, 0);  // a blob now
}

/// Removes the upload's row and file. `reason` is for the log.
void Uploads::forget(const std::string& id, std::string_view reason) {
    require_removable(folder_ / id);
    try {
        database_.write([&](Sql& sql) { sql.run("DELETE FROM uploads WHERE id = ?", {id}); });
    } catch (const Error& error) {
        if (error.system_error() != ENOSPC) throw;
        throw DeletionNeedsRoom(error, {folder_ / id});
    }
    FileCount removed, moved;
    if (kind_of_path(folder_ / id) == PathKind::folder) store_.put_aside(folder_ / id, moved);
    remove_counted(folder_ / id, removed);
    log_removal(removed, reason);
    log_move(moved, store_.lost_folder(), "a folder was in the place of an upload");
    room_.keep(id, 0);
}

void Uploads::remove(const std::string& id, std::string_view reason) {
    const Busy busy(*this, id);
    database_.read([&](Sql& sql) {
        if (sql.rows("SELECT 1 FROM uploads WHERE id = ?", {id}).empty()) refuse_unknown(id);
    });
    reserve_.run([&] { forget(id, reason); });
}

}  // namespace hairbake
