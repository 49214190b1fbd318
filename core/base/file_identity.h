// Tells whether a file changed between two readings of it.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>

namespace hairbake {

/// Device, inode, size, and the times of the last change of contents and of the inode (ns). Equal values mean that
/// nobody wrote to the file in between.
using FileIdentity = std::array<std::int64_t, 5>;

/// Empty where the system gives no facts of the file. Thread-safe.
std::optional<FileIdentity> identity_of(const std::filesystem::path& file);

}  // namespace hairbake
