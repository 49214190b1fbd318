// A file that is being received: its digest is computed while the bytes are written.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "core/base/digest.h"

namespace hairbake {

/// Not thread-safe. The destructor removes the file unless a store has adopted it.
class IncomingFile {
public:
    /// A new file of a random name in `folder`; at most `limit` bytes may be added.
    IncomingFile(const std::filesystem::path& folder, std::uint64_t limit);
    ~IncomingFile();
    IncomingFile(const IncomingFile&) = delete;
    IncomingFile& operator=(const IncomingFile&) = delete;

    /// Throws Refusal(too_large) beyond the limit.
    /// Throws Error(out_of_resources) for a full disk.
    void add(std::span<const std::byte> bytes);

    /// Syncs and closes the file; digest() is valid from now on, and nothing may be added any more.
    void finish();

    const std::filesystem::path& path() const { return path_; }
    std::uint64_t bytes() const { return bytes_; }
    const std::string& digest() const { return hex_; }

private:
    std::filesystem::path path_;
    std::uint64_t limit_, bytes_ = 0;
    int descriptor_;
    Digest digest_;
    std::string hex_;
};

}  // namespace hairbake
