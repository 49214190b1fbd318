#include "server/store/lost_found.h"

#include <spdlog/spdlog.h>

#include <ctime>
#include <string>
#include <system_error>
#include <utility>

#include "server/store/file_system.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

/// As 20261231T235959Z.
std::string time_name() {
    const std::time_t seconds = std::time(nullptr);
    std::tm utc{};
    char text[32];
    return std::string(text, std::strftime(text, sizeof text, "%Y%m%dT%H%M%SZ", ::gmtime_r(&seconds, &utc)));
}

/// A path in `folder` at which nothing is.
fs::path free_path(const fs::path& wanted) {
    fs::path path = wanted;
    for (int number = 1; fs::exists(fs::symlink_status(path)); ++number)
        path = wanted.string() + "-" + std::to_string(number);
    return path;
}

}  // namespace

LostFound::LostFound(fs::path store) : store_(std::move(store)), folder_(store_ / "lost+found" / time_name()) {}

FileCount LostFound::held() const {
    FileCount held;
    std::error_code closed;  // a file system's own lost+found is root's
    for (fs::recursive_directory_iterator entry(store_ / "lost+found", closed), end; !closed && entry != end;
         entry.increment(closed))
        if (std::error_code error; entry->is_regular_file(error)) {
            ++held.files;
            held.bytes += entry->file_size(error);
        }
    return held;
}

void LostFound::take(const fs::path& file, FileCount& count) try {
    std::error_code error;
    const std::uintmax_t bytes = fs::file_size(file, error);
    const fs::path wanted = folder_ / file.lexically_relative(store_);
    fs::create_directories(wanted.parent_path());
    fs::rename(file, free_path(wanted));
    ++count.files;
    count.bytes += error ? 0 : bytes;
} catch (const fs::filesystem_error& error) {
    spdlog::warn("{} stays where it is: {}", file.string(), error_text(error));
}

}  // namespace hairbake
