// A result file being written: bytes go to disk and into its digest at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/digest.h"

namespace hairbake {

/// The manifest's entry for a file of the result.
struct WrittenFile {
    std::string name;  ///< within the result folder
    std::string sha256;
    std::uint64_t bytes = 0;
    std::vector<std::size_t> shape;  ///< of arrays and images, rows first; else empty
    std::string content;             ///< one line for people
    std::optional<double> scale{};   ///< of half floats of radiance: value = stored half * scale
};

/// Writes one new file. Not thread-safe. A full disk, a quota or a size limit is Error(out_of_resources); any other
/// failure Error(bad_input) with the system's words. Both have the system's error number.
class FileSink {
public:
    explicit FileSink(const std::filesystem::path& file);
    ~FileSink();
    FileSink(const FileSink&) = delete;
    FileSink& operator=(const FileSink&) = delete;

    void write(std::span<const std::byte> bytes);
    void write(std::string_view text) { write(std::as_bytes(std::span(text))); }

    /// Flushes to the disk itself (fsync) and closes. Returns name, digest and size of the file.
    WrittenFile finish();

private:
    void flush();

    std::filesystem::path file_;
    int descriptor_;
    Digest digest_;
    std::uint64_t bytes_ = 0;
    std::vector<std::byte> pending_;  ///< small writes, collected
};

/// The hidden file beside `file` into which write_whole_file() writes until the file is whole.
std::filesystem::path part_of(const std::filesystem::path& file);

/// Removes part_of(file), for a process that ends during write_whole_file().
void discard_part(const std::filesystem::path& file) noexcept;

/// Writes a file that appears whole and replaces an existing one. `bytes` go to part_of(file) first; a failure removes
/// that file.
/// Throws as FileSink does, naming `file`, also where the name cannot be taken.
void write_whole_file(const std::filesystem::path& file, std::span<const std::byte> bytes);

/// Proves that write_whole_file() can write `file`: makes its hidden file and removes it again.
/// Throws as write_whole_file().
void prove_file_writable(const std::filesystem::path& file);

/// Error for the system's errno `error` about `file`: its kind separates a full disk from other failures.
[[noreturn]] void throw_system_error(const std::filesystem::path& file, int error);

}  // namespace hairbake
