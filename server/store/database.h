// The SQLite database of the service: one connection that writes, one that reads, whole transactions.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "server/store/pinned_files.h"
#include "server/store/refusal.h"

namespace hairbake {

using SqlValue = std::variant<std::nullptr_t, std::int64_t, double, std::string>;

/// One row of a result; columns are numbered as in the SELECT.
class SqlRow {
public:
    explicit SqlRow(std::vector<SqlValue> values) : values_(std::move(values)) {}

    bool null(std::size_t column) const;
    std::string text(std::size_t column) const;      ///< "" for NULL
    std::int64_t integer(std::size_t column) const;  ///< 0 for NULL
    double number(std::size_t column) const;         ///< 0 for NULL

private:
    std::vector<SqlValue> values_;
};

class DatabaseFiles;

/// SQLite found the file spoiled. The message names the file and tells what to do.
class SpoiledDatabase : public Refusal {
public:
    using Refusal::Refusal;
};

/// What to do with a database that is broken.
constexpr const char* advice_for_broken_database =
    "Move it away (with its -wal and -shm), restore a copy and run `hairbaked store accept --config FILE`: the next "
    "start then moves files that the copy does not know to lost+found. Without a copy, move the whole folder away and "
    "start with a new one: blobs/ in the old one still holds every input under its SHA-256";

/// Runs statements inside a transaction of Database. Statements are prepared once and kept.
/// Throws Error(out_of_resources) for a full or read-only disk, SpoiledDatabase for a broken file, Refusal(busy) when
/// another program holds the lock of the database for seconds, Error(internal) for other failures.
class Sql {
public:
    virtual ~Sql() = default;
    /// Returns how many rows were changed. Each `?` in `statement` stands for the next of `values`.
    virtual int run(std::string_view statement, const std::vector<SqlValue>& values = {}) = 0;
    virtual std::vector<SqlRow> rows(std::string_view statement, const std::vector<SqlValue>& values = {}) = 0;
    /// Gives `take` one row after the other until it returns false. Only one row is in memory. `take` may run other
    /// statements, not this one.
    virtual void each(std::string_view statement, const std::vector<SqlValue>& values,
                      const std::function<bool(const SqlRow&)>& take) = 0;
    /// Writes the number into the header of the database file (SQLite's application_id). It must grow.
    virtual void number_file(std::int32_t number) = 0;
};

/// What the owner of a database's folder checks. Empty functions check nothing; each may throw.
struct DatabaseHooks {
    std::function<void(int version)> before_upgrade;  ///< before a file of an earlier version is changed; 0: no tables
    std::function<void()> before_write;               ///< before each transaction, and again before its commit
};

/// WAL, synchronous FULL: a transaction that has returned is on the disk. Thread-safe. The locks are recursive, but
/// transactions do not nest. Readers never wait for the writer; only the writer waits for fsync.
class Database {
public:
    /// Opens or makes `file` and its tables; brings a database of an earlier version to this one.
    /// Throws Error(bad_input), telling what to do, when the file is no database of the service, broken, of a later
    /// version, or may not be read and written. It leaves no file behind that was not there before.
    /// Throws Error(out_of_resources) when memory or disk are short, or when another program holds the lock of the
    /// database for seconds.
    explicit Database(const std::filesystem::path& file, DatabaseHooks hooks = {});
    ~Database();

    /// Throws Refusal(busy) when the file, its -wal or its -shm was moved, deleted, replaced or overwritten.
    /// Throws SpoiledDatabase when SQLite found the file spoiled since the start.
    /// Throws what the hook before_write throws.
    void check_in_place() const;

    /// Runs `body` in one transaction: committed when it returns, rolled back when it throws. Throws as
    /// check_in_place(), too: then nothing is written.
    void write(const std::function<void(Sql&)>& body);
    /// Runs `body` on one committed state. `body` may not write and may not take lock().
    void read(const std::function<void(Sql&)>& body);
    /// Writes the log into the database file and cuts it to nothing, as far as no reader uses it and the disk allows.
    /// Returns whether the log is empty now. Call it outside of read() and write().
    bool shrink_log();
    /// Writes the log into the database file, as far as no reader uses it and the disk allows; waits for nobody.
    /// Returns the number that the file itself holds now (Sql::number_file).
    /// Throws as check_in_place().
    std::int32_t checkpoint();
    /// The last number that was committed (Sql::number_file).
    std::int32_t number() const { return last_number_; }
    /// From now on, a write() that makes the log longer than 1000 pages calls `act` instead of checkpoint(), which it
    /// must call.
    void when_log_is_long(std::function<void()> act);
    /// Grows with each write(), before it returns. A read() that began after this call is current while the number
    /// stays.
    std::uint64_t version() const { return version_; }
    /// Inside read(): version() as it was when read() began.
    std::uint64_t version_read() const { return version_read_; }
    /// Excludes all other writers. Hold it to keep files and rows in step.
    std::unique_lock<std::recursive_mutex> lock() { return std::unique_lock(writing_); }

private:
    class Connection;
    void open(const std::filesystem::path& file);
    void open_connections(const std::filesystem::path& file);
    void transact(const std::function<void(Sql&)>& body);
    void read_once(const std::function<void(Sql&)>& body);
    void keep_log_short();
    void stay_away_if_spoiled(const std::function<void()>& work);
    void remove_unused_log(const std::filesystem::path& file);

    std::recursive_mutex writing_, reading_;  ///< taken in this order
    const DatabaseHooks hooks_;
    std::unique_ptr<DatabaseFiles> files_;                          ///< closed after the connections
    std::atomic<std::int32_t> least_number_ = 0, last_number_ = 0;  ///< that the file itself may hold
    std::unique_ptr<Connection> writer_, reader_;
    PinnedFiles pins_;                       ///< the files that both connections have open
    std::function<void()> act_on_long_log_;  ///< guarded by writing_, as the next one
    int next_checkpoint_ = 0;  ///< pages of the log
    mutable std::mutex finding_;
    std::string spoiled_;  ///< guarded by finding_
    std::atomic<std::uint64_t> version_ = 0;
    bool in_read_ = false;            ///< guarded by reading_
    std::uint64_t version_read_ = 0;  ///< guarded by reading_
};

}  // namespace hairbake
