#include "server/store/database.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <spdlog/spdlog.h>
#include <sqlite3.h>

#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "core/base/error.h"
#include "server/store/database_errors.h"
#include "server/store/database_files.h"
#include "server/store/file_system.h"
#include "server/store/schema.h"
#include "server/store/store_access.h"

namespace hairbake {

bool SqlRow::null(std::size_t column) const { return std::holds_alternative<std::nullptr_t>(values_.at(column)); }

std::string SqlRow::text(std::size_t column) const {
    const std::string* text = std::get_if<std::string>(&values_.at(column));
    return text ? *text : std::string();
}

std::int64_t SqlRow::integer(std::size_t column) const {
    const std::int64_t* integer = std::get_if<std::int64_t>(&values_.at(column));
    return integer ? *integer : 0;
}

double SqlRow::number(std::size_t column) const {
    const double* number = std::get_if<double>(&values_.at(column));
    return number ? *number : static_cast<double>(integer(column));
}

namespace {

constexpr int start_patience_ms = 5000, usual_patience_ms = 3000;
constexpr int patience_while_locked_ms = 200;  ///< after a wait was in vain: the requests behind it wait for it, too
constexpr int long_log = 1000;                 ///< pages

SqlValue value_of(const SQLite::Column& column) {
    switch (column.getType()) {
        case SQLITE_INTEGER:
            return column.getInt64();
        case SQLITE_FLOAT:
            return column.getDouble();
        case SQLITE_NULL:
            return nullptr;
        default:
            return column.getString();
    }
}

void bind(SQLite::Statement& statement, const std::vector<SqlValue>& values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
        const int at = static_cast<int>(i) + 1;
        if (const auto* integer = std::get_if<std::int64_t>(&values[i]))
            statement.bind(at, static_cast<int64_t>(*integer));
        else if (const auto* number = std::get_if<double>(&values[i]))
            statement.bind(at, *number);
        else if (const auto* text = std::get_if<std::string>(&values[i]))
            statement.bind(at, *text);
        else
            statement.bind(at);
    }
}

}  // namespace

class Database::Connection : public Sql {
public:
    Connection(const std::filesystem::path& file, int flags) : database(file.string(), flags, start_patience_ms) {
        let_close_change_files(false);
        ::sqlite3_wal_hook(  // in place of SQLite's own checkpoints
            database.getHandle(),
            [](void* self, sqlite3*, const char*, int pages) {
                static_cast<Connection*>(self)->log_pages_ = pages;
                return SQLITE_OK;
            },
            this);
    }

    /// After the last commit.
    int log_pages() const { return log_pages_; }

    /// How long a statement waits for the lock of another program.
    void wait_at_most(int milliseconds) {
        if (std::exchange(patience_ms_, milliseconds) != milliseconds)
            ::sqlite3_busy_timeout(database.getHandle(), milliseconds);
    }

    std::int32_t number() { return database.execAndGet("PRAGMA application_id").getInt(); }

    void number_file(std::int32_t number) override {
        try {
            database.exec("PRAGMA application_id = " + std::to_string(number));
        } catch (const SQLite::Exception& error) {
            throw_failed_statement(error, database.getFilename());
        }
        if (on_number) on_number(number);
    }

    /// The version of the file, 0 in an empty one, and how many tables and indices it has. Changes nothing.
    std::pair<int, int> version_and_tables() {
        const int version = database.execAndGet("PRAGMA user_version").getInt();
        return {version, database.execAndGet("SELECT count(*) FROM sqlite_master").getInt()};
    }

    /// Settings, check and tables of the connection that writes.
    void prepare_file(int found) {
        database.exec("PRAGMA journal_mode = WAL");
        database.exec("PRAGMA synchronous = FULL");
        const std::string check = database.execAndGet("PRAGMA quick_check(1)").getString();
        if (check != "ok") throw Error(ErrorKind::bad_input, check);
        if (found == schema_version) return;
        SQLite::Transaction transaction(database);
        for (int from = found; from < schema_version; ++from) database.exec(schema_statements(from));
        database.exec("PRAGMA user_version = " + std::to_string(schema_version));
        transaction.commit();
    }

    int run(std::string_view statement, const std::vector<SqlValue>& values) override {
        try {
            SQLite::Statement& prepared = prepare(statement, values);
            const int changed = prepared.exec();
            prepared.reset();
            return changed;
        } catch (const SQLite::Exception& error) {
            throw_failed_statement(error, database.getFilename());
        }
    }

    std::vector<SqlRow> rows(std::string_view statement, const std::vector<SqlValue>& values) override {
        std::vector<SqlRow> rows;
        each(statement, values, [&](const SqlRow& row) {
            rows.push_back(row);
            return true;
        });
        return rows;
    }

    void each(std::string_view statement, const std::vector<SqlValue>& values,
              const std::function<bool(const SqlRow&)>& take) override {
        try {
            SQLite::Statement& prepared = prepare(statement, values);
            const struct Reset {  // also when `take` throws or ends early
                SQLite::Statement& statement;
                ~Reset() { statement.tryReset(); }
            } reset{prepared};
            const int columns = prepared.getColumnCount();
            while (prepared.executeStep()) {
                std::vector<SqlValue> row;
                row.reserve(static_cast<std::size_t>(columns));
                for (int i = 0; i < columns; ++i) row.push_back(value_of(prepared.getColumn(i)));
                if (!take(SqlRow(std::move(row)))) return;
            }
        } catch (const SQLite::Exception& error) {
            throw_failed_statement(error, database.getFilename());
        }
    }

    /// Whether closing the last connection writes -wal into the database and deletes it. Until the start is complete,
    /// and when the files were replaced, it must not: they may be those of another database.
    void let_close_change_files(bool let) {
        ::sqlite3_db_config(database.getHandle(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, let ? 0 : 1, nullptr);
    }

    SQLite::Database database;
    std::function<void(std::int32_t)> on_number;  ///< called after number_file()

private:
    SQLite::Statement& prepare(std::string_view text, const std::vector<SqlValue>& values) {
        auto found = statements_.find(text);
        if (found == statements_.end()) {
            const std::string owned(text);
            found = statements_.emplace(owned, SQLite::Statement(database, owned)).first;
        }
        SQLite::Statement& statement = found->second;
        statement.tryReset();
        statement.clearBindings();
        bind(statement, values);
        return statement;
    }

    std::map<std::string, SQLite::Statement, std::less<>> statements_;
    int log_pages_ = 0, patience_ms_ = start_patience_ms;
};

namespace {

void check_version(const std::filesystem::path& file, int version, int tables) {
    const std::string name = "the database " + file.string(), unchanged = ". Nothing was changed or removed. ";
    if (version < 0 || (version == 0 && tables > 0))
        throw Error(ErrorKind::bad_input, name + " is of another program" + unchanged +
                                              "Let [store] folder name the folder of a store, or an empty one");
    if (version > schema_version)
        throw Error(ErrorKind::bad_input, name + ": its version is " + std::to_string(version) +
                                              "; this program reads up to " + std::to_string(schema_version) +
                                              unchanged + "Start the newer program that made it");
}

/// SQLite opens a file that it may not write all the same, and fails later.
void check_files(const std::filesystem::path& file) {
    std::error_code missing;
    const std::filesystem::path real = std::filesystem::canonical(file, missing);
    for (const char* end : {"", "-wal", "-shm"})
        check_access(file.parent_path(), (missing ? file : real).string() + end);
}

/// Page 1 of the log hides that of the file, so an older log would spoil the file.
void check_log_is_younger(const std::filesystem::path& file, std::optional<std::int64_t> in_file, std::int32_t in_log) {
    if (!in_file || *in_file <= in_log) return;
    const std::string log = file.string() + "-wal";
    throw Error(ErrorKind::bad_input,
                "the log " + log + " is older than the database beside it: their numbers are " +
                    std::to_string(in_log) + " and " + std::to_string(*in_file) +
                    ". Nothing was changed or removed. Put back the -wal that was beside this database. If there was "
                    "none, move this one away (with its -shm)");
}

}  // namespace

Database::Database(const std::filesystem::path& file, DatabaseHooks hooks) : hooks_(std::move(hooks)) {
    check_files(file);
    try {
        open(file);
    } catch (...) {
        reader_.reset();
        remove_unused_log(file);
        throw;
    }
}

void Database::open(const std::filesystem::path& file) {
    std::error_code missing;
    const std::filesystem::path there = std::filesystem::canonical(file, missing);
    DatabaseFiles::require_room(missing ? file : there);
    const std::optional<std::int64_t> in_file = DatabaseFiles::number_in(file);
    open_connections(file);
    const std::string real = std::filesystem::canonical(file).string();
    files_ = std::make_unique<DatabaseFiles>(real);
    check_log_is_younger(file, in_file, writer_->number());
    least_number_ = static_cast<std::int32_t>(files_->number().value_or(0));
    last_number_ = writer_->number();
    writer_->on_number = [this](std::int32_t number) { last_number_ = number; };
    const std::string save =
        "Put back the file that was there before; docs/deployment.md tells how to save a deleted database";
    pins_ = PinnedFiles({{file, save},
                         {real + "-wal", save},
                         {real + "-shm", "Put it back, or restart the daemon: SQLite makes a new one at the start"}});
}

void Database::open_connections(const std::filesystem::path& file) {
    const std::string name = "the database " + file.string();
    const std::string advice = std::string(". Nothing was removed. ") + advice_for_broken_database;
    const auto attempt = [&](const std::function<void()>& step) {
        try {
            step();
        } catch (const SQLite::Exception& error) {
            throw_if_system_failed(error, file);
            throw Error(ErrorKind::bad_input, name + " cannot be opened: " + error.what() + advice);
        } catch (const Error& error) {
            if (error.kind() == ErrorKind::out_of_resources) throw;
            throw Error(ErrorKind::bad_input, name + " is not whole: " + error.what() + advice);
        }
    };
    int version = 0, tables = 0;
    attempt([&] {
        writer_ = std::make_unique<Connection>(file, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
        std::tie(version, tables) = writer_->version_and_tables();
    });
    check_version(file, version, tables);
    if (version < schema_version && hooks_.before_upgrade) hooks_.before_upgrade(version);
    attempt([&] {
        writer_->prepare_file(version);
        SQLite::Transaction(writer_->database, SQLite::TransactionBehavior::IMMEDIATE);  // nobody else holds the lock
        reader_ = std::make_unique<Connection>(file, SQLite::OPEN_READONLY);
        reader_->rows("SELECT count(*) FROM sqlite_master", {});  // opens its files
    });
    for (const auto& connection : {writer_.get(), reader_.get()}) connection->wait_at_most(usual_patience_ms);
}

Database::~Database() {
    try {
        check_in_place();
        if (version_ > 0)
            writer_->let_close_change_files(true);
        else  // the start was stopped
            remove_unused_log(writer_->database.getFilename());
    } catch (const std::exception&) {  // the files stay as they are
    }
}

/// Reading a database makes an empty -wal and a -shm beside it. Lets SQLite delete them when the writer closes: nothing
/// is written into the database then.
void Database::remove_unused_log(const std::filesystem::path& file) {
    std::error_code missing;
    const std::filesystem::path real = std::filesystem::canonical(file, missing);
    const std::uintmax_t logged = std::filesystem::file_size(real.string() + "-wal", missing);
    if (writer_ && !missing && logged == 0) writer_->let_close_change_files(true);
}

void Database::check_in_place() const {
    if (hooks_.before_write) hooks_.before_write();
    pins_.check();
    files_->check(least_number_, last_number_);
    const std::lock_guard held(finding_);
    if (!spoiled_.empty()) throw SpoiledDatabase(Refused::busy, spoiled_);
}

/// A write into a spoiled file may spoil more.
void Database::stay_away_if_spoiled(const std::function<void()>& work) {
    try {
        work();
    } catch (const SpoiledDatabase& found) {
        const std::lock_guard held(finding_);
        spoiled_ = found.what();
        throw;
    }
}

void Database::write(const std::function<void(Sql&)>& body) {
    const auto held = lock();
    check_in_place();
    stay_away_if_spoiled([&] { transact(body); });
    keep_log_short();
}

void Database::transact(const std::function<void(Sql&)>& body) {
    try {
        // Rolled back by its destructor when the body throws.
        SQLite::Transaction transaction(writer_->database, SQLite::TransactionBehavior::IMMEDIATE);
        writer_->wait_at_most(usual_patience_ms);
        body(*writer_);
        check_in_place();
        transaction.commit();
        ++version_;
    } catch (const SQLite::Exception& error) {
        if (is_locked(error)) writer_->wait_at_most(patience_while_locked_ms);
        throw_failed_statement(error, writer_->database.getFilename());
    }
}

/// What was committed stays so when this fails. After a checkpoint that a reader hindered, the next one comes when the
/// log has as many pages more.
void Database::keep_log_short() {
    const int pages = writer_->log_pages();
    if (pages < long_log) next_checkpoint_ = long_log;
    if (pages < next_checkpoint_) return;
    try {
        act_on_long_log_ ? act_on_long_log_() : static_cast<void>(checkpoint());
    } catch (const std::exception& error) {
        spdlog::warn("the database's log cannot be shortened: {}", error_text(error));
    }
}

void Database::when_log_is_long(std::function<void()> act) {
    const auto held = lock();
    act_on_long_log_ = std::move(act);
}

std::int32_t Database::checkpoint() {
    const auto held = lock();
    next_checkpoint_ = writer_->log_pages() + long_log;  // whoever makes this one may write while it holds locks
    check_in_place();
    try {
        writer_->rows("PRAGMA wal_checkpoint(PASSIVE)", {});
    } catch (const Error&) {  // the database file cannot grow
    }
    const auto number = static_cast<std::int32_t>(files_->number().value_or(0));
    least_number_ = number;
    return number;
}

bool Database::shrink_log() {
    const auto held = lock();
    const std::unique_lock no_reader(reading_);
    try {
        check_in_place();
        return writer_->rows("PRAGMA wal_checkpoint(TRUNCATE)", {}).at(0).integer(0) == 0;
    } catch (const Error&) {  // the database file cannot grow
        return false;
    }
}

void Database::read(const std::function<void(Sql&)>& body) {
    stay_away_if_spoiled([&] { read_once(body); });
}

void Database::read_once(const std::function<void(Sql&)>& body) {
    const std::unique_lock held(reading_);
    if (in_read_) return body(*reader_);  // inside another read(): the same state
    struct Reading {
        bool& now;
        explicit Reading(bool& flag) : now(flag) { now = true; }
        ~Reading() { now = false; }
    } const reading{in_read_};
    version_read_ = version_;
    try {
        reader_->run("BEGIN", {});
        try {
            body(*reader_);
        } catch (...) {
            reader_->run("ROLLBACK", {});
            throw;
        }
        reader_->run("ROLLBACK", {});  // there is nothing to commit
    } catch (const SQLite::Exception& error) {
        throw_failed_statement(error, writer_->database.getFilename());
    }
}

}  // namespace hairbake
