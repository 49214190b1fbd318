#include "server/store/incoming_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "core/base/assert.h"
#include "server/store/file_system.h"
#include "server/store/refusal.h"

namespace hairbake {

IncomingFile::IncomingFile(const std::filesystem::path& folder, std::uint64_t limit, std::optional<Room::Share> share,
                           WhenFull when_full)
    : path_(folder / random_name()),
      limit_(limit),
      descriptor_(::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0640)),
      when_full_(when_full),
      share_(std::move(share)) {
    if (descriptor_ >= 0) return;
    if (when_full_ == WhenFull::refuse) throw_store_error(path_, errno);
    drop_file();
}

IncomingFile::~IncomingFile() { drop_file(); }

/// The room is given back after the file. unlink() fails when a store has renamed the file.
void IncomingFile::drop_file() {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
    if (has_file()) ::unlink(path_.c_str());
    path_.clear();
    share_.reset();
}

void IncomingFile::add(std::span<const std::byte> bytes) {
    HAIRBAKE_ASSERT(hex_.empty());  // before finish()
    if (bytes.size() > limit_ - bytes_)
        throw Refusal(Refused::too_large, "the body is longer than " + std::to_string(limit_) + " bytes");
    if (has_file()) write(bytes);
    digest_.add(bytes);
    bytes_ += bytes.size();
}

void IncomingFile::write(std::span<const std::byte> bytes) try {
    if (share_) share_->grow(bytes.size());
    write_all(descriptor_, bytes, path_);
} catch (const std::exception&) {  // no room in the store, or none on the disk
    if (when_full_ == WhenFull::refuse) throw;
    drop_file();
}

void IncomingFile::count() {
    if (share_) share_->count();
}

void IncomingFile::give_back() {
    if (share_) share_->give_back();
}

void IncomingFile::finish() {
    if (has_file()) close_file();
    hex_ = digest_.hex();
}

void IncomingFile::close_file() try {
    sync_file(descriptor_, path_);
    const int closed = ::close(descriptor_);
    descriptor_ = -1;
    if (closed != 0) throw_store_error(path_, errno);
} catch (const std::exception&) {
    if (when_full_ == WhenFull::refuse) throw;
    drop_file();
}

}  // namespace hairbake
