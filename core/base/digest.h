// SHA-256. Everything that hairbake stores is named by it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace hairbake {

/// SHA-256 of bytes fed in pieces. Not thread-safe.
class Digest {
public:
    Digest();
    ~Digest();
    Digest(Digest&&) noexcept;
    Digest& operator=(Digest&&) noexcept;

    Digest& add(std::span<const std::byte> bytes);
    Digest& add(std::string_view text);

    /// 64 lower-case hexadecimal digits. Ends the digest: nothing may be added afterwards.
    std::string hex();

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Digest of the bytes of a file, as hexadecimal digits.
/// Throws Error(bad_input), with the system's error number, when the file cannot be read.
std::string digest_of_file(const std::filesystem::path& file);

}  // namespace hairbake
