// Calls of the file system that make data durable or fail with the reason.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace hairbake {

/// `error` is errno. The message holds the folder of the file, the system's text, and what to do.
/// Throws Refusal(busy) when memory or descriptors are short.
/// Throws Error(out_of_resources) for a disk that is full or cannot be written, Error(internal) otherwise.
[[noreturn]] void throw_store_error(const std::filesystem::path& file, int error);

/// Writes all bytes.
/// Throws as throw_store_error().
void write_all(int descriptor, std::span<const std::byte> bytes, const std::filesystem::path& file);

void sync_file(int descriptor, const std::filesystem::path& file);
void sync_folder(const std::filesystem::path& folder);

/// Makes the folder and its missing parents.
void make_folder(const std::filesystem::path& folder);

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

}  // namespace hairbake
