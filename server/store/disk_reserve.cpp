#include "server/store/disk_reserve.h"

#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string>

#include "server/store/database.h"
#include "server/store/file_system.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t page = 4096;

/// Of a regular file; 0 when there is none.
std::uint64_t size_of(const fs::path& file) {
    struct stat facts {};
    return ::lstat(file.c_str(), &facts) == 0 && S_ISREG(facts.st_mode) ? static_cast<std::uint64_t>(facts.st_size) : 0;
}

/// Bytes on the disk that are free when the file is cut. 0 for a file that has another name, too.
std::uint64_t bytes_to_free(const fs::path& file) {
    struct stat facts {};
    if (::lstat(file.c_str(), &facts) != 0 || !S_ISREG(facts.st_mode) || facts.st_nlink != 1) return 0;
    return static_cast<std::uint64_t>(facts.st_blocks) * 512;
}

/// Returns whether files of enough bytes were cut.
bool cut(const std::vector<fs::path>& files) {
    std::uint64_t bytes = 0;
    for (const fs::path& file : files) bytes += bytes_to_free(file);
    if (bytes < DiskReserve::enough) return false;
    std::uint64_t freed = 0;
    for (const fs::path& file : files)
        if (const std::uint64_t own = bytes_to_free(file); own > 0 && ::truncate(file.c_str(), 0) == 0) freed += own;
    spdlog::warn("the disk is full: {} bytes of files that are being deleted are freed before the database is written",
                 freed);
    return freed > 0;
}

/// For a person whose deletion was refused.
std::string what_works(const fs::path& folder) {
    const std::string store = folder.string(), kib = std::to_string(DiskReserve::enough >> 10) + " KiB";
    return "A deletion needs room for some pages of the database. Delete an input of at least " + kib +
           " first: its own bytes are used for that (GET /v1/blobs lists inputs with their sizes). Or free " + kib +
           " on this disk by hand: files of other programs, or files in " + store +
           "/lost+found that you have looked at. Do not remove files in " + store + "/blobs by hand";
}

}  // namespace

void DiskReserve::fill() { grow(free_bytes(file_.parent_path()) / 2); }

/// By at most so many bytes.
void DiskReserve::grow(std::uint64_t most) {
    const std::uint64_t size = size_of(file_);
    if (size >= bytes || most < page) return;
    const auto held = database_.lock();
    if (size == 0) ::unlink(file_.c_str());  // what is no file has no place here
    const Descriptor reserve(::open(file_.c_str(), O_WRONLY | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0640));
    if (!reserve) return;
    for (std::uint64_t more = std::min(bytes - size, most) / page * page; more >= page; more = more / 2 / page * page)
        if (::posix_fallocate(reserve.get(), 0, static_cast<off_t>(size + more)) == 0) return;
    if (size == 0 || ::ftruncate(reserve.get(), static_cast<off_t>(size)) != 0) ::unlink(file_.c_str());
}

/// Whether there was a reserve.
bool DiskReserve::release() {
    const std::uint64_t size = size_of(file_);
    if (size == 0 || ::unlink(file_.c_str()) != 0) return false;
    spdlog::warn("the disk of {} is full: the {} bytes of {} are given to a deletion", file_.parent_path().string(),
                 size, file_.filename().string());
    return true;
}

void DiskReserve::release_if_full(const fs::path& folder) {
    const fs::path file = folder / "reserve";
    if (size_of(file) == 0 || free_bytes(folder) >= enough || ::unlink(file.c_str()) != 0) return;
    spdlog::warn("the disk of {} is full: the file {} is removed, so that the store can be opened", folder.string(),
                 file.string());
}

void DiskReserve::run(const std::function<void()>& deletion) {
    const auto held = database_.lock();  // no other transaction takes the freed bytes
    if (run_with_help(deletion)) database_.shrink_log();
    grow(free_bytes(file_.parent_path()));
}

/// Returns whether the disk was full.
bool DiskReserve::run_with_help(const std::function<void()>& deletion) {
    std::vector<fs::path> files;
    std::string found;
    const auto works = [&] {
        try {
            deletion();
            return true;
        } catch (const Error& error) {
            if (error.kind() != ErrorKind::out_of_resources) throw;
            if (error.system_error() != ENOSPC)  // room does not help
                throw Error(error.kind(), std::string("nothing was changed: ") + error.what(), {},
                            error.system_error());
            const auto* const doomed = dynamic_cast<const DeletionNeedsRoom*>(&error);
            files = doomed ? doomed->files() : std::vector<fs::path>();
        }
        return false;
    };
    if (works()) return false;
    if (release() && works()) return true;
    if (database_.shrink_log() && works()) return true;
    const bool is_cut = cut(files);
    if (is_cut && works()) return true;
    const fs::path folder = file_.parent_path();
    throw Error(
        ErrorKind::out_of_resources,
        std::string(is_cut ? "the bytes of the file were removed, and its entry stays: " : "nothing was changed: ") +
            "the database " + (folder / "hairbake.db").string() + " cannot grow: its disk is full. " +
            what_works(folder),
        {}, ENOSPC);
}

}  // namespace hairbake
