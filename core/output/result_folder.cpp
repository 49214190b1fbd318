#include "core/output/result_folder.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <system_error>

#include "core/base/error.h"
#include "core/output/file_sink.h"
#include "core/output/manifest.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

/// Absolute, links followed, without a slash at the end.
fs::path resolved(const fs::path& folder) {
    std::error_code error;
    fs::path path = fs::weakly_canonical(fs::absolute(folder, error), error).lexically_normal();
    if (error) throw_system_error(folder, error.value());
    if (!path.has_filename()) path = path.parent_path();
    return path;
}

/// Both are canonical.
bool is_within(const fs::path& place, const fs::path& folder) {
    const auto [end, rest] = std::mismatch(folder.begin(), folder.end(), place.begin(), place.end());
    return end == folder.end();
}

/// Nothing can be renamed to the place of a mounted file system.
bool is_mount_point(const fs::path& folder) {
    struct statx facts {};
    return ::statx(AT_FDCWD, folder.c_str(), 0, 0, &facts) == 0 && (facts.stx_attributes & STATX_ATTR_MOUNT_ROOT);
}

[[noreturn]] void refuse(const fs::path& folder, const std::string& why) {
    throw Error(
        ErrorKind::usage,
        folder.string() + " " + why + "; results go to a new or empty folder, or replace an earlier result of hairbake",
        "out");
}

void sync_folder(const fs::path& folder) {
    const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) throw_system_error(folder, errno);
    ::fsync(descriptor);
    ::close(descriptor);
}

bool move(const fs::path& from, const fs::path& to, unsigned flags) {
    return ::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), flags) == 0;
}

/// ".NAME.hairbake-HOST-": the names of the staging folders of `path` on this machine begin with it.
std::string staging_prefix(const fs::path& path) {
    char host[256] = "";
    ::gethostname(host, sizeof host - 1);
    return std::string(".").append(path.filename().string()).append(".hairbake-").append(host).append("-");
}

/// Removes staging folders that processes of this machine left when they were killed. Those of other machines that
/// share the file system cannot be judged from here, and stay.
void collect_leftovers(const fs::path& path) {
    const std::string prefix = staging_prefix(path);
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(path.parent_path(), error)) {
        const std::string name = entry.path().filename().string();
        if (!name.starts_with(prefix)) continue;
        int process = 0;
        const char* const end = name.data() + name.size();
        const auto [rest, problem] = std::from_chars(name.data() + prefix.size(), end, process);
        const bool ours = problem == std::errc() && process > 0 && (rest == end || *rest == '-');
        if (ours && ::kill(process, 0) != 0 && errno == ESRCH) fs::remove_all(entry.path(), error);
    }
}

}  // namespace

void check_result_folder(const fs::path& folder) {
    if (folder.empty()) throw Error(ErrorKind::usage, "out is empty; allowed is the path of a folder", "out");
    std::error_code error;
    const fs::file_status status = fs::status(folder, error);
    if (status.type() == fs::file_type::not_found) return;
    if (error) refuse(folder, "cannot be looked at: " + error.message());
    if (!fs::is_directory(status)) refuse(folder, "is not a folder");
    if (is_mount_point(folder)) refuse(folder, "is a mount point, which cannot be replaced; name a folder in it");
    fs::directory_iterator entries(folder, error);
    if (error) refuse(folder, "cannot be read: " + error.message());
    if (entries == fs::directory_iterator()) return;

    if (!fs::exists(folder / "manifest.json")) refuse(folder, "holds files and no manifest.json");
    std::vector<std::string> known;
    try {
        known = files_of_result(folder);
    } catch (const Error& unreadable) {
        refuse(folder, std::string("holds a manifest.json that is not hairbake's (") + unreadable.what() + ")");
    }
    known.push_back("manifest.json");
    for (const fs::directory_entry& entry : entries) {
        const std::string name = entry.path().filename().string();
        if (std::find(known.begin(), known.end(), name) == known.end())
            refuse(folder, "holds " + name + ", which its manifest.json does not list");
    }
}

void prove_writable(const fs::path& folder) try {
    check_result_folder(folder);
    const ResultFolder made_and_removed(folder);
} catch (const Error& error) {
    throw Error(error.kind(), error.what(), "out", error.system_error());
}

void check_outside(const fs::path& folder, std::span<const NamedInput> inputs) {
    std::error_code error;
    const fs::path inside = fs::canonical(folder, error);
    if (error) return;  // there is nothing that could be deleted
    for (const NamedInput& input : inputs) {
        const fs::path parent = input.file.has_parent_path() ? input.file.parent_path() : fs::path(".");
        for (const fs::path& place : {input.file, parent})
            if (const fs::path found = fs::canonical(place, error); !error && is_within(found, inside))
                throw Error(ErrorKind::usage,
                            input.name + " is " + input.file.string() + ", which lies in the result folder " +
                                folder.string() +
                                ": writing the result would delete it; give another --out, or copy the input elsewhere",
                            input.name);
    }
}

fs::path staging_folder(const fs::path& folder) {
    const fs::path path = resolved(folder);
    return path.parent_path() / (staging_prefix(path) + std::to_string(::getpid()));
}

void discard_staging(const fs::path& folder) noexcept {
    try {
        // Moved away first, in one step: a commit that comes later finds nothing to move into place.
        const fs::path staging = staging_folder(folder);
        const fs::path gone = staging.string() + "-gone";
        std::error_code error;
        fs::rename(staging, gone, error);
        if (!error) fs::remove_all(gone, error);
    } catch (const std::exception&) {
        // A process that ends can do nothing more.
    }
}

ResultFolder::ResultFolder(const fs::path& folder)
    : given_(folder), folder_(resolved(folder)), staging_(staging_folder(folder)) {
    check_result_folder(given_);
    const fs::path parent = folder_.parent_path();
    for (fs::path p = parent; !fs::exists(p) && p.has_relative_path(); p = p.parent_path()) made_parent_ = p;
    std::error_code error;
    fs::create_directories(parent, error);
    if (error) throw_system_error(given_, error.value());
    collect_leftovers(folder_);
    fs::remove_all(staging_, error);  // of an earlier process with this number
    fs::create_directory(staging_, error);
    if (error) throw_system_error(given_, error.value());
}

std::string ResultFolder::as_given(std::string text) const {
    const std::string staging = staging_.string(), given = given_.string();
    for (std::size_t at = text.find(staging); at != std::string::npos; at = text.find(staging, at + given.size()))
        text.replace(at, staging.size(), given);
    return text;
}

ResultFolder::~ResultFolder() {
    std::error_code ignored;
    fs::remove_all(staging_, ignored);  // after a commit: the earlier result, if there was one
    if (committed_ || made_parent_.empty()) return;
    for (fs::path p = folder_.parent_path(); fs::remove(p, ignored) && p != made_parent_;) p = p.parent_path();
}

void ResultFolder::commit() {
    sync_folder(staging_);
    if (!move(staging_, folder_, RENAME_NOREPLACE)) {
        if (errno != EEXIST && errno != EINVAL && errno != ENOSYS) throw_system_error(given_, errno);
        replace();
    }
    committed_ = true;
    sync_folder(folder_.parent_path());
}

/// The folder is there: empty, or with an earlier result.
void ResultFolder::replace() {
    if (move(staging_, folder_, 0)) return;  // it was empty
    if (errno != ENOTEMPTY && errno != EEXIST) throw_system_error(given_, errno);
    check_result_folder(given_);  // again: the folder may have changed during the bake
    if (move(staging_, folder_, RENAME_EXCHANGE)) return;
    if (errno != EINVAL && errno != ENOSYS) throw_system_error(given_, errno);

    // A file system without exchange: the earlier result steps aside first.
    const fs::path aside = staging_.string() + "-old";
    if (!move(folder_, aside, 0)) throw_system_error(given_, errno);
    if (!move(staging_, folder_, 0)) {
        const int error = errno;
        move(aside, folder_, 0);
        throw_system_error(given_, error);
    }
    std::error_code ignored;
    fs::remove_all(aside, ignored);
}

}  // namespace hairbake
