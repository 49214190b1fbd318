// Calls of the file system that make data durable or fail with the reason.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <span>
#include <string>

namespace hairbake {

/// `error` is errno. The message holds the folder of the file, the system's text, and what to do.
/// Throws Refusal(busy) when memory or descriptors are short.
/// Throws Error(out_of_resources) for a disk that is full or cannot be written, Error(internal) otherwise.
[[noreturn]] void throw_store_error(const std::filesystem::path& file, int error);

/// The message for people. That of std::filesystem ("filesystem error: status: Permission denied [...]") is replaced by
/// the path, the system's reason and what to do; any other stays.
std::string error_text(const std::exception& error);

/// What is at a path. A symbolic link counts as what it leads to.
enum class PathKind {
    nothing,
    file,    ///< a regular file
    folder,  ///< a directory
    other,   ///< a named pipe, a socket, a device, or a link that leads to itself
    unknown  ///< the system does not say
};

PathKind kind_of_path(const std::filesystem::path& path);

/// Whether a regular file is at the path itself: a symbolic link is none.
bool is_plain_file(const std::filesystem::path& path);

/// "a folder", "a named pipe" and so on: what is at the path itself, for people. Links are not followed.
std::string words_for_path(const std::filesystem::path& path);

/// Writes all bytes.
/// Throws as throw_store_error().
void write_all(int descriptor, std::span<const std::byte> bytes, const std::filesystem::path& file);

void sync_file(int descriptor, const std::filesystem::path& file);
void sync_folder(const std::filesystem::path& folder);

/// Makes the folder and its missing parents.
void make_folder(const std::filesystem::path& folder);

/// Bytes that this process may write on the disk of the folder; 0 when the system does not tell.
std::uint64_t free_bytes(const std::filesystem::path& folder);

/// 128 random bits as 32 hexadecimal digits, from the kernel.
std::string random_name();

/// A file descriptor that closes itself.
class Descriptor {
public:
    explicit Descriptor(int descriptor = -1) : descriptor_(descriptor) {}
    ~Descriptor();
    Descriptor(Descriptor&& other) noexcept : descriptor_(other.release()) {}
    Descriptor& operator=(Descriptor&& other) noexcept;

    int get() const { return descriptor_; }
    explicit operator bool() const { return descriptor_ >= 0; }
    int release();

private:
    int descriptor_;
};

/// A file that was opened, or the reason why not.
struct OpenedFile {
    Descriptor file;                 ///< of a regular file
    PathKind kind = PathKind::file;  ///< of what is at the path; `file` without a descriptor: it cannot be opened now
    int error = 0;                   ///< errno where the system does not open or does not say
};

/// Opens the regular file at `path`. Never waits, whatever is there: a plain open() of a named pipe waits for its other
/// end. `flags` are those of open(2), without O_CREAT.
OpenedFile open_file(const std::filesystem::path& path, int flags);

}  // namespace hairbake
