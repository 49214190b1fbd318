// How BlobStore finds bytes that do not have their digest.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "core/base/digest.h"
#include "server/store/blob_store.h"
#include "server/store/database.h"
#include "server/store/refusal.h"
#include "server/store/store_advice.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

/// Whether the open file is the one at `path`.
bool is_at(const fs::path& path, int descriptor) {
    struct stat open {
    }, there{};
    return ::fstat(descriptor, &open) == 0 && ::stat(path.c_str(), &there) == 0 && open.st_dev == there.st_dev &&
           open.st_ino == there.st_ino;
}

}  // namespace

/// The reason why the file cannot be read may pass, so nothing is forgotten. `error` is errno, or 0 where the file was
/// replaced or removed meanwhile.
void BlobStore::refuse_for_now(const std::string& digest, int error) const {
    const std::string found = "the stored bytes of sha256:" + digest + " cannot be read now";
    if (error == 0 || error == ENOENT || error == ENOTDIR || error == ELOOP) check_folder_of(digest);
    if (error == 0)
        throw Refusal(Refused::busy, found + ": the file was replaced or removed at this moment. Try again");
    throw Refusal(Refused::busy,
                  found + ": " + std::generic_category().message(error) + ". " + advice_for(path_of(digest), error));
}

/// Throws LostBlob when nothing is in the blob's place, or anything but a file.
/// Throws Refusal(busy) for a file that cannot be opened now.
Descriptor BlobStore::open_blob_file(const std::string& digest, const OnLoss& on_loss) {
    OpenedFile opened = open_file(path_of(digest), O_RDONLY);
    if (opened.file) return std::move(opened.file);
    if (opened.kind == PathKind::file || opened.kind == PathKind::unknown) refuse_for_now(digest, opened.error);
    lose_without_file(digest, on_loss);
}

/// A folder that is missing with the file hides more files than this one, so nothing is forgotten then.
void BlobStore::lose_without_file(const std::string& digest, const OnLoss& on_loss) {
    const auto held = database_.lock();  // it may have been removed and sent again meanwhile
    const fs::path path = path_of(digest);
    const PathKind kind = kind_of_path(path);
    const bool is_lost = kind == PathKind::nothing || kind == PathKind::folder || kind == PathKind::other;
    if (!is_lost || kind_of_path(path.parent_path()) != PathKind::folder || !size_of(digest)) refuse_for_now(digest);
    throw lose(digest, on_loss);
}

std::string BlobStore::advice_for_closed(const std::vector<std::string>& digests) const {
    for (const std::string& digest : digests)
        if (::faccessat(AT_FDCWD, path_of(digest).c_str(), R_OK, AT_EACCESS) != 0 && errno != ENOENT)
            return ". " + advice_for(path_of(digest), errno);
    return {};
}

bool BlobStore::is_verified(const std::string& digest, const FileFacts& facts) {
    const std::lock_guard lock(mutex_);
    const auto verified = verified_.find(digest);
    return verified != verified_.end() && verified->second.facts == facts;
}

void BlobStore::note_verified(const std::string& digest, const FileFacts& facts) {
    const std::lock_guard lock(mutex_);
    verified_[digest] = checked_[digest] = {now(), facts};
}

void BlobStore::note_check_failed(const std::string& digest) {
    const std::lock_guard lock(mutex_);
    checked_[digest] = {now(), FileFacts{}};
}

void BlobStore::note_other_link_removed(const std::string& digest) {
    const std::optional<FileFacts> facts = facts_of(path_of(digest));
    const std::lock_guard lock(mutex_);
    const auto verified = verified_.find(digest);
    if (!facts || verified == verified_.end()) return;
    FileFacts& known = verified->second.facts;
    if (known.bytes == facts->bytes && known.mtime_ns == facts->mtime_ns) known.ctime_ns = facts->ctime_ns;
}

/// The facts are taken before the bytes are read: a change meanwhile shows at the next opening.
void BlobStore::verify(const std::string& digest, int descriptor, const OnLoss& on_loss,
                       const std::function<void(std::size_t)>& pace) {
    const std::optional<FileFacts> facts = facts_of(descriptor);
    if (!facts) refuse_for_now(digest, errno);
    if (!pace && is_verified(digest, *facts)) return;
    Digest found;
    std::vector<std::byte> piece(1 << 18);
    ssize_t count = 0;
    for (off_t at = 0; (count = ::pread(descriptor, piece.data(), piece.size(), at)) > 0; at += count) {
        found.add(std::span(piece).first(static_cast<std::size_t>(count)));
        if (pace) pace(static_cast<std::size_t>(count));
    }
    if (count < 0) refuse_for_now(digest, errno);
    if (found.hex() == digest) return note_verified(digest, *facts);
    const auto held = database_.lock();
    if (!is_at(path_of(digest), descriptor) || !size_of(digest))
        refuse_for_now(digest);  // replaced or removed meanwhile
    throw lose(digest, on_loss);
}

std::vector<std::string> BlobStore::unchecked_since(double time, int most) {
    std::vector<std::string> digests;
    database_.read([&](Sql& sql) {
        for (const SqlRow& row : sql.rows("SELECT sha256 FROM blobs WHERE checked < ? ORDER BY checked LIMIT ?",
                                          {time, std::int64_t(most)}))
            digests.push_back(row.text(0));
    });
    return digests;
}

void BlobStore::check_digest(const std::string& digest, const OnLoss& on_loss,
                             const std::function<void(std::size_t)>& pace) {
    if (!size_of(digest)) return;
    const Descriptor file = open_blob_file(digest, on_loss);
    ::posix_fadvise(file.get(), 0, 0, POSIX_FADV_DONTNEED);  // the disk's bytes, not those that memory remembers
    verify(digest, file.get(), on_loss, pace);
    ::posix_fadvise(file.get(), 0, 0, POSIX_FADV_DONTNEED);
}

}  // namespace hairbake
