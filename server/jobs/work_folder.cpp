#include "server/jobs/work_folder.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <span>
#include <system_error>

#include "server/store/file_system.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

constexpr off_t reserved_for_words = 256 << 10;

Descriptor create(const fs::path& file) {
    Descriptor descriptor(::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0640));
    if (!descriptor) throw_store_error(file, errno);
    return descriptor;
}

void reserve_words(const fs::path& file) {
    const Descriptor words = create(file);
    if (::fallocate(words.get(), FALLOC_FL_KEEP_SIZE, 0, reserved_for_words) != 0 && errno != EOPNOTSUPP)
        throw_store_error(file, errno);
}

void remove_folder(const fs::path& folder) {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
}

}  // namespace

WorkFolder::WorkFolder(const fs::path& parent, const std::string& task_json) : path_(parent / random_name()) {
    make_folder(path_);
    try {
        const fs::path task = path_ / "task.json";
        write_all(create(task).get(), std::as_bytes(std::span(task_json)), task);
        reserve_words(words());
    } catch (...) {
        remove_folder(path_);
        throw;
    }
}

WorkFolder::WorkFolder(fs::path path) : path_(std::move(path)) {}

WorkFolder::~WorkFolder() {
    if (!is_left_) remove_folder(path_);
}

}  // namespace hairbake
