#include "server/store/incoming_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "core/base/assert.h"
#include "server/store/file_system.h"
#include "server/store/refusal.h"

namespace hairbake {

IncomingFile::IncomingFile(const std::filesystem::path& folder, std::uint64_t limit, std::optional<Room::Share> share)
    : path_(folder / random_name()),
      limit_(limit),
      descriptor_(::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0640)),
      share_(std::move(share)) {
    if (descriptor_ < 0) throw_store_error(path_, errno);
}

IncomingFile::~IncomingFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    ::unlink(path_.c_str());  // fails when a store has renamed it
}

void IncomingFile::add(std::span<const std::byte> bytes) {
    HAIRBAKE_ASSERT(descriptor_ >= 0);  // before finish()
    if (bytes.size() > limit_ - bytes_)
        throw Refusal(Refused::too_large, "the body is longer than " + std::to_string(limit_) + " bytes");
    if (share_) share_->grow(bytes.size());
    write_all(descriptor_, bytes, path_);
    digest_.add(bytes);
    bytes_ += bytes.size();
}

void IncomingFile::count() {
    if (share_) share_->count();
}

void IncomingFile::give_back() {
    if (share_) share_->give_back();
}

void IncomingFile::finish() {
    sync_file(descriptor_, path_);
    const int closed = ::close(descriptor_);
    descriptor_ = -1;
    if (closed != 0) throw_store_error(path_, errno);
    hex_ = digest_.hex();
}

}  // namespace hairbake
