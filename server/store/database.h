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

namespace hairbake {

using SqlValue = std::variant<std::nullptr_t, std::int64_t, double, std::string>;

/// One row of an answer; columns by their position in the SELECT.
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

/// Runs statements inside a transaction of Database. Statements are prepared once and kept. A failure is
/// Error(out_of_resources) for a full disk, Error(internal) otherwise.
class Sql {
public:
    virtual ~Sql() = default;
    /// How many rows were changed. `?` in `statement` stand for `values` in turn.
    virtual int run(std::string_view statement, const std::vector<SqlValue>& values = {}) = 0;
    virtual std::vector<SqlRow> rows(std::string_view statement, const std::vector<SqlValue>& values = {}) = 0;
};

/// WAL, synchronous FULL: a transaction that has returned is on the disk. Thread-safe; the locks are recursive, but
/// transactions do not nest. Who reads does not wait for who writes, whose commits wait for the disk.
class Database {
public:
    /// Opens or makes `file` and its tables. Throws Error(bad_input) with what to do when the file is no database of
    /// this version or not whole.
    explicit Database(const std::filesystem::path& file);
    ~Database();

    /// Runs `body` in one transaction: committed when it returns, rolled back when it throws.
    void write(const std::function<void(Sql&)>& body);
    /// Runs `body` on one state of what is committed; it only reads. It may not write or take lock() inside.
    void read(const std::function<void(Sql&)>& body);
    /// Grows with each write(), before it returns: what was read after asking holds while the number stays.
    std::uint64_t version() const { return version_; }
    /// To be asked inside read(): version() as it was when that began.
    std::uint64_t version_read() const { return version_read_; }
    /// Held by who must keep files and rows in step: nobody else writes meanwhile.
    std::unique_lock<std::recursive_mutex> lock() { return std::unique_lock(writing_); }

private:
    class Connection;
    std::recursive_mutex writing_, reading_;  ///< in this order
    std::unique_ptr<Connection> writer_, reader_;
    std::atomic<std::uint64_t> version_ = 0;
    bool in_read_ = false;            ///< under reading_
    std::uint64_t version_read_ = 0;  ///< under reading_
};

}  // namespace hairbake
