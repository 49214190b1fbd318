#include "server/store/file_system.h"

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

#include "core/base/error.h"
#include "server/store/refusal.h"
#include "server/store/store_advice.h"

namespace hairbake {

void throw_store_error(const std::filesystem::path& file, int error) {
    const bool full = error == ENOSPC || error == EDQUOT || error == EFBIG;
    const bool busy = error == ENOMEM || error == EMFILE || error == ENFILE;
    const bool closed = error == EROFS || error == EACCES || error == EPERM || error == EIO;
    const std::string words = std::generic_category().message(error);
    const std::string place = " in " + file.parent_path().string() + ": " + words + ". " + advice_for(file, error);
    if (busy) throw Refusal(Refused::busy, "the store is short of memory or descriptors: " + words);
    if (full) throw Error(ErrorKind::out_of_resources, "the store cannot grow" + place);
    if (closed) throw Error(ErrorKind::out_of_resources, "the store cannot be written" + place, {}, error);
    throw Error(ErrorKind::internal, "the store's " + file.string() + ": " + words);
}

std::string error_text(const std::exception& error) {
    const auto* const failed = dynamic_cast<const std::filesystem::filesystem_error*>(&error);
    if (!failed) return error.what();
    const std::filesystem::path& path = failed->path1();
    return (path.empty() ? "a file of the store" : path.string()) + " cannot be used: " + failed->code().message() +
           ". " + advice_for(path, failed->code().value());
}

namespace {

PathKind kind_of_mode(mode_t mode) {
    if (S_ISREG(mode)) return PathKind::file;
    return S_ISDIR(mode) ? PathKind::folder : PathKind::other;
}

PathKind kind_of_error(int error) {
    if (error == ENOENT) return PathKind::nothing;
    return error == ELOOP ? PathKind::other : PathKind::unknown;
}

}  // namespace

PathKind kind_of_path(const std::filesystem::path& path) {
    struct stat facts {};
    return ::stat(path.c_str(), &facts) == 0 ? kind_of_mode(facts.st_mode) : kind_of_error(errno);
}

bool is_plain_file(const std::filesystem::path& path) {
    struct stat facts {};
    return ::lstat(path.c_str(), &facts) == 0 && S_ISREG(facts.st_mode);
}

std::string words_for_path(const std::filesystem::path& path) {
    struct stat facts {};
    if (::lstat(path.c_str(), &facts) != 0) return "nothing";
    switch (facts.st_mode & S_IFMT) {
        case S_IFREG:
            return "a file";
        case S_IFDIR:
            return "a folder";
        case S_IFIFO:
            return "a named pipe";
        case S_IFSOCK:
            return "a socket";
        case S_IFLNK:
            return "a symbolic link";
        default:
            return "a device";
    }
}

void write_all(int descriptor, std::span<const std::byte> bytes, const std::filesystem::path& file) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) throw_store_error(file, errno);
        bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
}

void sync_file(int descriptor, const std::filesystem::path& file) {
    if (::fsync(descriptor) != 0) throw_store_error(file, errno);
}

void sync_folder(const std::filesystem::path& folder) {
    const Descriptor descriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (!descriptor) throw_store_error(folder, errno);
    sync_file(descriptor.get(), folder);
}

void make_folder(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) throw_store_error(folder, error.value());
}

std::uint64_t free_bytes(const std::filesystem::path& folder) {
    struct statvfs disk {};
    return ::statvfs(folder.c_str(), &disk) == 0 ? static_cast<std::uint64_t>(disk.f_bavail) * disk.f_frsize : 0;
}

std::string random_name() {
    std::array<unsigned char, 16> bits{};
    if (::getrandom(bits.data(), bits.size(), 0) != static_cast<ssize_t>(bits.size()))
        throw Error(ErrorKind::internal, "the kernel gives no random bytes");
    std::string name;
    for (const unsigned char byte : bits) {
        char digits[3];
        std::snprintf(digits, sizeof digits, "%02x", byte);
        name += digits;
    }
    return name;
}

Descriptor::~Descriptor() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
    if (this != &other) {
        if (descriptor_ >= 0) ::close(descriptor_);
        descriptor_ = other.release();
    }
    return *this;
}

int Descriptor::release() { return std::exchange(descriptor_, -1); }

OpenedFile open_file(const std::filesystem::path& path, int flags) {
    OpenedFile opened{Descriptor(::open(path.c_str(), flags | O_CLOEXEC | O_NONBLOCK | O_NOCTTY))};
    struct stat facts {};
    if (opened.file && ::fstat(opened.file.get(), &facts) == 0) {
        opened.kind = kind_of_mode(facts.st_mode);
        if (opened.kind != PathKind::file) opened.file = Descriptor();
        return opened;
    }
    opened.error = errno;
    opened.file = Descriptor();
    opened.kind = kind_of_path(path);  // a socket, some devices and a pipe without a reader cannot be opened
    if (opened.kind == PathKind::nothing && opened.error != ENOENT) opened.kind = PathKind::unknown;  // gone meanwhile
    return opened;
}

}  // namespace hairbake
