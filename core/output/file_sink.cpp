#include "core/output/file_sink.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "core/base/error.h"

namespace hairbake {

void throw_system_error(const std::filesystem::path& file, int error) {
    const bool full = error == ENOSPC || error == EDQUOT || error == EFBIG || error == ENOMEM || error == EMFILE;
    throw Error(full ? ErrorKind::out_of_resources : ErrorKind::bad_input,
                file.string() + " cannot be written: " + std::generic_category().message(error), {}, error);
}

FileSink::FileSink(const std::filesystem::path& file)
    : file_(file), descriptor_(::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666)) {
    if (descriptor_ < 0) throw_system_error(file_, errno);
}

FileSink::~FileSink() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

void FileSink::write(std::span<const std::byte> bytes) {
    constexpr std::size_t piece = 1 << 18;
    while (!bytes.empty()) {
        const std::size_t count = std::min(bytes.size(), piece - pending_.size());
        pending_.insert(pending_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count));
        bytes = bytes.subspan(count);
        if (pending_.size() == piece) flush();
    }
}

void FileSink::flush() {
    digest_.add(pending_);
    bytes_ += pending_.size();
    for (std::span<const std::byte> rest = pending_; !rest.empty();) {
        const ssize_t written = ::write(descriptor_, rest.data(), rest.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) throw_system_error(file_, errno);
        rest = rest.subspan(static_cast<std::size_t>(written));
    }
    pending_.clear();
}

WrittenFile FileSink::finish() {
    flush();
    if (::fsync(descriptor_) != 0 && errno != EINVAL) throw_system_error(file_, errno);
    const int closed = ::close(descriptor_);
    descriptor_ = -1;
    if (closed != 0) throw_system_error(file_, errno);
    return {file_.filename().string(), digest_.hex(), bytes_, {}, {}, {}};
}

namespace {

/// Errors name `file`, which the person knows, and not the hidden one.
void write_part(const std::filesystem::path& file, std::span<const std::byte> bytes) {
    discard_part(file);
    try {
        FileSink sink(part_of(file));
        sink.write(bytes);
        sink.finish();
    } catch (const Error& error) {
        discard_part(file);
        if (error.system_error() == 0) throw;
        throw_system_error(file, error.system_error());
    }
}

}  // namespace

std::filesystem::path part_of(const std::filesystem::path& file) {
    return file.parent_path() / (".part-" + file.filename().string());
}

void discard_part(const std::filesystem::path& file) noexcept {
    try {
        std::error_code ignored;
        std::filesystem::remove(part_of(file), ignored);
    } catch (const std::exception&) {
        // Nothing more can be done.
    }
}

void prove_file_writable(const std::filesystem::path& file) {
    std::error_code error;
    if (std::filesystem::is_directory(file, error)) throw_system_error(file, EISDIR);
    const std::filesystem::path parent = file.parent_path();
    if (!parent.empty() && std::filesystem::status(parent, error).type() == std::filesystem::file_type::not_found)
        throw Error(ErrorKind::bad_input,
                    file.string() + " cannot be written: there is no folder " + parent.string() + "; make it first",
                    "out", ENOENT);
    write_part(file, {});
    discard_part(file);
}

void write_whole_file(const std::filesystem::path& file, std::span<const std::byte> bytes) {
    write_part(file, bytes);
    std::error_code error;
    std::filesystem::rename(part_of(file), file, error);
    if (!error) return;
    discard_part(file);
    throw_system_error(file, error.value());
}

}  // namespace hairbake
