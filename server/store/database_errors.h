// What failures of SQLite mean for requests, and for the start of the daemon.
#pragma once

#include <filesystem>

namespace SQLite {
class Exception;
}

namespace hairbake {

/// Whether another program holds a lock of the database.
bool is_locked(const SQLite::Exception& error);

/// For a statement that failed on the open database `file`.
/// Throws Refusal(busy) when another program holds its lock, SpoiledDatabase when it is broken,
/// Error(out_of_resources) when it cannot be written, Error(internal) otherwise.
[[noreturn]] void throw_failed_statement(const SQLite::Exception& error, const std::filesystem::path& file);

/// For a database that cannot be opened: returns when the file itself is at fault.
/// Throws Error(out_of_resources) for what passes (a full or failing disk, little memory, a lock of another program),
/// Error(bad_input) when this process may not use the file.
void throw_if_system_failed(const SQLite::Exception& error, const std::filesystem::path& file);

}  // namespace hairbake
