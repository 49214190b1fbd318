// Whether a store's folder and its database belong together, and are of one time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>

namespace hairbake {

class Database;

/// A store has a random id and a generation. Both stand in the file `store-id` of its folder and in the table `store`.
///
/// The generation grows at each start, at each clean stop, and once a minute while the database changes: first in the
/// database, then in the file. So a crash between both leaves the database one ahead of the file. A database that is
/// behind the file is an old copy, and a database that is two or more ahead has a folder that is an old copy. A copy
/// that is so young that it has the present generation is not told: its start removes no files either, it moves those
/// that it does not know to lost+found.
///
/// The header of the database file holds a generation, too (Sql::number_file), and `store-id` the one that the file
/// itself held, without its log, when the generation began. A file whose header is of an earlier generation is an older
/// copy, even when the -wal of the newer database lies beside it.
///
/// Thread-safe.
class StoreIdentity {
public:
    static constexpr const char* file_name = "store-id";
    static constexpr int first_version = 6;  ///< of the database: the first with a table `store`
    static constexpr const char* advice_for_copy =
        "Put the newer database back with its -wal. To work with this one all the same, run `hairbaked store accept "
        "--config FILE`: "
        "the next start then moves files that the database does not know to lost+found";

    /// Compares folder and database; gives a new store, or one of an earlier version, its file. The caller has locked
    /// the folder. `expected_id` is the id that the settings give, or empty.
    /// Throws Error(bad_input), telling what to do, when the two do not belong together.
    StoreIdentity(std::filesystem::path folder, Database& database, const std::string& expected_id);

    /// Before the database is opened: SQLite would take the pages of the log beside it for its own.
    /// Throws Error(bad_input), telling what to do, when the -wal is that of a newer database.
    static void check_log_belongs(const std::filesystem::path& folder, const std::filesystem::path& database);

    /// 32 hexadecimal digits.
    const std::string& id() const { return id_; }
    /// Whether accept() came since the last start: then stored files may be missing.
    bool accepted() const { return accepted_; }

    /// Begins the next generation.
    /// Throws as Database::write() and throw_store_error(); calling it again is then harmless.
    void advance();
    /// advance() if the database has changed since the last call.
    void advance_if_changed();
    /// Writes the file `store-id` if advance() could not.
    /// Throws Error(out_of_resources) with the reason when it still cannot be written.
    void check_recorded();

    /// Makes the folder and the database one store of the present generation, whatever they were before. Keeps the
    /// folder's id if it has one. When root runs it, the file gets the owner of the folder.
    /// Throws Error(bad_input) when the file of the folder may not be read.
    static void accept(const std::filesystem::path& folder, Database& database);

private:
    struct Mark {
        std::string id;
        std::int64_t generation = 0;
        std::int64_t header = 0;  ///< least generation in the header of the database file; 0: not known
    };
    static std::optional<Mark> read_valid_mark(const std::filesystem::path& folder);
    static std::optional<Mark> read_mark(const std::filesystem::path& folder);
    static void write_mark(const std::filesystem::path& folder, const Mark& mark);
    void compare(const Mark& row) const;
    void record(const Mark& mark);

    std::filesystem::path folder_;
    Database& database_;
    std::string id_;
    bool accepted_ = false;
    std::mutex mutex_;                ///< guards the members below
    std::int64_t generation_ = 0;     ///< that the file has
    std::uint64_t version_ = 0;       ///< Database::version() at the last advance()
    std::optional<Mark> unrecorded_;  ///< that the file should have
};

}  // namespace hairbake
