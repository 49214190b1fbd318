#include "server/store/database_files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "core/base/error.h"
#include "server/store/refusal.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

constexpr off_t index_bytes = 32 << 10;        ///< of the first part of the log's index, which lasts for 4062 pages
constexpr off_t index_bytes_long = 128 << 10;  ///< of four parts
constexpr std::uint64_t plenty = 1 << 20;      ///< free bytes of a disk that has room for four parts
constexpr std::size_t log_header = 32, page_header = 24;

std::uint32_t big_endian(const unsigned char* bytes) {
    return std::uint32_t(bytes[0]) << 24 | std::uint32_t(bytes[1]) << 16 | std::uint32_t(bytes[2]) << 8 | bytes[3];
}

bool read_at_start(int descriptor, unsigned char* bytes, std::size_t count) {
    return ::pread(descriptor, bytes, count, 0) == static_cast<ssize_t>(count);
}

std::int64_t size_of(int descriptor) {
    struct stat facts {};
    return ::fstat(descriptor, &facts) == 0 ? static_cast<std::int64_t>(facts.st_size) : 0;
}

std::optional<std::int64_t> number_of(int descriptor) {
    std::array<unsigned char, 100> header{};
    if (!read_at_start(descriptor, header.data(), header.size())) return std::nullopt;
    if (std::memcmp(header.data(), "SQLite format 3", 16) != 0) return std::nullopt;
    return static_cast<std::int32_t>(big_endian(header.data() + 68));  // "application ID"
}

Descriptor open_for(const fs::path& file, int flags) { return Descriptor(::open(file.c_str(), flags | O_CLOEXEC)); }

/// One of the two equal copies of the header of the log's index; its numbers are in the order of this machine.
struct IndexHeader {
    std::array<unsigned char, 48> bytes{};

    bool is_made() const { return bytes[12] != 0; }
    std::uint32_t pages() const { return word(16); }  ///< that were committed into the log
    std::size_t page_bytes() const {
        std::uint16_t bytes_or_one = 0;
        std::memcpy(&bytes_or_one, bytes.data() + 14, sizeof bytes_or_one);
        return bytes_or_one == 1 ? 65536 : bytes_or_one;
    }
    const unsigned char* salts() const { return bytes.data() + 32; }

private:
    std::uint32_t word(std::size_t at) const {
        std::uint32_t value = 0;
        std::memcpy(&value, bytes.data() + at, sizeof value);
        return value;
    }
};

/// Nothing while SQLite writes it.
std::optional<IndexHeader> index_header(int descriptor) {
    std::array<unsigned char, 96> both{};
    if (!read_at_start(descriptor, both.data(), both.size())) return std::nullopt;
    if (std::memcmp(both.data(), both.data() + 48, 48) != 0) return std::nullopt;
    IndexHeader header;
    std::copy_n(both.begin(), header.bytes.size(), header.bytes.begin());
    return header;
}

/// Whether the log has the pages of the index.
bool log_has(int log, const IndexHeader& index) {
    if (!index.is_made() || index.pages() == 0) return true;
    const std::size_t bytes = log_header + index.pages() * (page_header + index.page_bytes());
    std::array<unsigned char, log_header> header{};
    return size_of(log) >= static_cast<std::int64_t>(bytes) && read_at_start(log, header.data(), header.size()) &&
           std::memcmp(header.data() + 16, index.salts(), 8) == 0;
}

}  // namespace

void throw_disk_full(const fs::path& database) {
    const std::string store = database.parent_path().string();
    throw Error(ErrorKind::out_of_resources,
                "the database " + database.string() +
                    " cannot be opened: its disk is full: " + std::to_string(free_bytes(database.parent_path())) +
                    " bytes are free. Nothing was changed or removed. Free at least 256 KiB on this disk: files of "
                    "other programs, or files in " +
                    store + "/lost+found that you have looked at. Do not remove files in " + store + "/blobs",
                {}, ENOSPC);
}

DatabaseFiles::DatabaseFiles(const fs::path& database)
    : path_(database),
      file_(open_for(database, O_RDONLY)),
      log_(open_for(database.string() + "-wal", O_RDONLY)),
      index_(open_for(database.string() + "-shm", O_RDWR)) {
    give_index_room();
}

void DatabaseFiles::give_index_room() const {
    if (free_bytes(path_.parent_path()) > plenty && ::posix_fallocate(index_.get(), 0, index_bytes_long) == 0) return;
    const int error = ::posix_fallocate(index_.get(), 0, index_bytes);
    if (error == ENOSPC || error == EDQUOT) throw_disk_full(path_);
}

/// SQLite cuts the index of a process that ended, so the blocks of that file are free then.
void DatabaseFiles::require_room(const fs::path& database) {
    struct stat facts {};
    const off_t has = ::stat((database.string() + "-shm").c_str(), &facts) == 0 ? facts.st_blocks * 512 : 0;
    if (has >= index_bytes) return;
    const Descriptor trial(::open(database.parent_path().c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600));
    if (!trial) return;  // the file system has no files without a name
    const int error = ::posix_fallocate(trial.get(), 0, index_bytes - has);
    if (error == ENOSPC || error == EDQUOT) throw_disk_full(database);
}

std::optional<std::int64_t> DatabaseFiles::number() const { return number_of(file_.get()); }

std::optional<std::int64_t> DatabaseFiles::number_in(const fs::path& database) {
    const OpenedFile opened = open_file(database, O_RDONLY | O_CLOEXEC);
    return opened.file ? number_of(opened.file.get()) : std::nullopt;
}

bool DatabaseFiles::file_is_ours(std::int64_t least, std::int64_t most) const {
    const std::optional<std::int64_t> found = number();
    const std::int64_t bytes = size_of(file_.get());
    if (!found || *found < least || *found > most || bytes < largest_bytes_) return false;
    largest_bytes_ = bytes;
    return true;
}

/// The index is read again when the log is not as it says: SQLite may have begun the log anew in between.
bool DatabaseFiles::log_is_ours() const {
    for (int attempt = 0; attempt < 100; ++attempt) {
        const std::optional<IndexHeader> before = index_header(index_.get());
        if (before && log_has(log_.get(), *before)) return true;
        const std::optional<IndexHeader> after = index_header(index_.get());
        if (before && after && before->bytes == after->bytes) return false;
    }
    return true;  // SQLite is at work
}

void DatabaseFiles::check(std::int64_t least, std::int64_t most) const {
    const auto refuse = [this](const char* end) {
        const std::string path = path_.string();
        throw Refusal(Refused::busy,
                      path + end +
                          " was overwritten or cut by another program while the daemon works with it; nothing is "
                          "written. Put its bytes back. If you cannot, stop the daemon, move " +
                          path +
                          " away (with its -wal and -shm), restore a copy and run `hairbaked store accept --config "
                          "FILE`");
    };
    for (int attempt = 1; !file_is_ours(least, most); ++attempt)  // our own checkpoint may write it now
        if (attempt == 3) refuse("");
    if (!log_is_ours()) refuse("-wal");
}

}  // namespace hairbake
