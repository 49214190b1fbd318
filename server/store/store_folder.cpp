#include "server/store/store_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string_view>
#include <utility>

#include "core/base/error.h"
#include "server/store/disk_reserve.h"
#include "server/store/store_access.h"
#include "server/store/store_identity.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

/// Folders whose files the daemon renames into each other.
constexpr std::array parts{"blobs", "uploads", "tmp"};

constexpr const char* advice_without_store =
    "`hairbaked store accept --config FILE` takes a store that is there. Does [store] folder in FILE name the right "
    "folder, and is its disk mounted? To make a new store, start the daemon";

[[noreturn]] void stop_start(const std::string& found, const std::string& advice) {
    throw Error(ErrorKind::bad_input, found + ". Nothing was changed or removed. " + advice);
}

/// Throws Error(usage) when another process holds the lock. File systems on which a folder cannot be locked have the
/// file `lock` alone.
Descriptor lock_path(const fs::path& path, int flags, const fs::path& store) {
    check_access(store, path);
    Descriptor lock(::open(path.c_str(), flags | O_CLOEXEC, 0640));
    if (!lock) throw_store_error(path, errno);
    give_owner_of(store, lock.get());
    if (::flock(lock.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
        throw Error(ErrorKind::usage, "another hairbaked works on the store " + store.string());
    return lock;
}

/// The folder and its parts with what a person can do when one is gone or replaced. A restart takes what is there then.
std::vector<PinnedFiles::Path> pinned_parts(const fs::path& folder) {
    const std::string restart = "Put it back, or restart the daemon, which makes a new one";
    return {
        {folder, "Put the folder back that was there before"},
        {folder / "lock", restart},
        {folder / "tmp", restart},
        {folder / "uploads", restart + "; the unfinished uploads in the old one are lost then"},
        {folder / "blobs", "Put the folder back that was there before. To use what is there now, restart the daemon"}};
}

void require_usable(const fs::path& folder) {
    if (::faccessat(AT_FDCWD, folder.c_str(), R_OK | W_OK | X_OK, AT_EACCESS) == 0) return;
    if (errno != ENOENT) throw_store_error(folder / "file", errno);
    throw Error(ErrorKind::out_of_resources,
                "the folder " + folder.string() +
                    " is missing. Put it back with its files, or restart the daemon, which makes an empty one");
}

dev_t device_of(const fs::path& path, dev_t otherwise) {
    struct stat facts {};
    return ::stat(path.c_str(), &facts) == 0 ? facts.st_dev : otherwise;
}

std::uint64_t files_in(const fs::path& folder) {
    std::error_code error;
    std::uint64_t files = 0;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder, error))
        if (entry.symlink_status().type() != fs::file_type::directory) ++files;
    return files;
}

/// An entry that is no part of a store, or a file in tmp/; empty when there is none. A killed first start leaves an
/// empty database. A file system of its own has a lost+found.
std::string foreign_entry(const fs::path& folder) {
    constexpr std::array<std::string_view, 9> known{
        "lock",        "lost+found",          "blobs",           "uploads",        "tmp",
        "hairbake.db", "hairbake.db-journal", "hairbake.db-wal", "hairbake.db-shm"};
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        if (std::find(known.begin(), known.end(), name) == known.end()) return name;
    }
    std::error_code missing;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder / "tmp", missing))
        return "tmp/" + entry.path().filename().string();
    return {};
}

}  // namespace

StoreFolder::StoreFolder(fs::path folder, const std::string& expected_id, StoreUse use)
    : path_(std::move(folder)), expected_id_(expected_id), use_(use) {
    if (std::error_code error; use_ == StoreUse::accept && fs::status(path_, error).type() == fs::file_type::not_found)
        stop_start("the folder " + path_.string() + " does not exist", advice_without_store);
    make_store_folder(path_, path_);
    folder_lock_ = lock_path(path_, O_RDONLY | O_DIRECTORY, path_);
    check_database_file();
    check_parts();
    StoreIdentity::check_log_belongs(path_, database());
    lock_ = lock_path(path_ / "lock", O_RDWR | O_CREAT, path_);
    make_parts();
    pins_ = PinnedFiles(pinned_parts(path_));
    DiskReserve::release_if_full(path_);
}

void StoreFolder::check_usable() const {
    for (const char* part : parts) require_usable(path_ / part);
    constexpr std::string_view digits = "0123456789abcdef";
    for (const char high : digits)
        for (const char low : digits) require_usable(path_ / "blobs" / std::string{high, low});
}

DatabaseHooks StoreFolder::hooks() const {
    return {[this](int version) { check_before_upgrade(version); }, [this] { check_in_place(); }};
}

DatabaseHooks StoreFolder::hooks_to_accept() const {
    return {[this](int version) {
                if (version == 0) check_before_new_database();
            },
            [this] { check_in_place(); }};
}

/// SQLite would delete a log that has no database, so this comes before the database is opened.
void StoreFolder::check_database_file() const {
    std::error_code missing;
    const std::uintmax_t bytes = fs::file_size(database(), missing);
    if (!missing && bytes > 0) return;
    if (missing && missing != std::errc::no_such_file_or_directory)
        stop_start("the database " + database().string() + " cannot be read: " + missing.message(),
                   "Put the database in its place");
    const fs::path log = database().string() + "-wal";
    std::error_code no_log;
    if (const std::uintmax_t logged = fs::file_size(log, no_log); !no_log && logged > 0)
        stop_start("the database " + database().string() + (missing ? " is missing" : " is empty") + ", and its " +
                       log.filename().string() + " of " + std::to_string(logged) + " bytes is there",
                   "Put the database back beside it: both belong together");
    check_before_new_database();
}

void StoreFolder::check_before_new_database() const {
    const std::string folder = path_.string();
    const std::uint64_t blobs = files_in(path_ / "blobs"), uploads = files_in(path_ / "uploads");
    const bool has_id = fs::exists(path_ / StoreIdentity::file_name);
    if (has_id || blobs > 0 || uploads > 0)
        stop_start("the database " + database().string() + " is missing or empty, and the store's folder holds " +
                       std::to_string(blobs) + " files in blobs and " + std::to_string(uploads) + " in uploads",
                   "Put the database back with its -wal, or restore a copy of it and run `hairbaked store "
                   "accept --config FILE`. Without a copy, move the whole folder away and start with a new one: blobs/ "
                   "in the old one still "
                   "holds every input under its SHA-256");
    if (const std::string entry = foreign_entry(path_); !entry.empty())
        stop_start("the folder " + folder + " is no store: it holds " + entry,
                   "Let [store] folder name an empty folder or one that does not exist");
    if (!expected_id_.empty())
        stop_start("the folder " + folder + " is empty; allowed is the store " + expected_id_ + " ([store] id)",
                   "Is its disk mounted? To make a new store there, remove id from the settings");
    if (use_ == StoreUse::accept)
        stop_start("the folder " + folder + " holds no store: it has no database", advice_without_store);
}

void StoreFolder::check_before_upgrade(int version) const {
    if (version == 0) return check_before_new_database();
    if (version < StoreIdentity::first_version && fs::exists(path_ / StoreIdentity::file_name))
        stop_start("the database " + database().string() + " is older than the store in " + path_.string() +
                       ": it is of version " + std::to_string(version) + ", from before the store had an id",
                   StoreIdentity::advice_for_copy);
}

/// The database checks its own files.
void StoreFolder::check_parts() const {
    check_access(path_, path_ / StoreIdentity::file_name, false);
    for (const char* part : parts) check_access(path_, path_ / part);
    std::error_code missing;
    for (const fs::directory_entry& entry : fs::directory_iterator(path_ / "blobs", missing))
        if (std::error_code error; entry.is_directory(error)) check_access(path_, entry.path());
}

/// Blobs and uploads are renamed and linked between the parts, so all must be on one device.
void StoreFolder::make_parts() const {
    for (const char* part : parts) make_store_folder(path_, path_ / part);
    const dev_t device = device_of(path_, 0);
    std::vector<fs::path> folders{path_ / "lost+found"};
    for (const char* part : parts) folders.push_back(path_ / part);
    if (std::error_code error; fs::exists(database(), error))
        folders.push_back(fs::canonical(database()).parent_path());
    for (const fs::directory_entry& entry : fs::directory_iterator(path_ / "blobs")) folders.push_back(entry.path());
    for (const fs::path& folder : folders)
        if (fs::is_directory(folder) && device_of(folder, device) != device)
            stop_start(folder.string() + " is on another device than the store's folder " + path_.string(),
                       "Keep all parts of the store on one device: mount the whole folder");
}

}  // namespace hairbake
