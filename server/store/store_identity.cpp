#include "server/store/store_identity.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <fstream>
#include <span>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "server/store/database.h"
#include "server/store/database_files.h"
#include "server/store/file_system.h"
#include "server/store/store_access.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

constexpr const char* is_untouched = ". Nothing was changed or removed. ";
constexpr const char* advice_to_accept =
    "If both belong together all the same, run `hairbaked store accept --config FILE`: the next start then moves "
    "files that the database does not know to lost+found";

}  // namespace

/// Nothing when there is no file.
std::optional<StoreIdentity::Mark> StoreIdentity::read_mark(const fs::path& folder) {
    const fs::path file = folder / file_name;
    check_access(folder, file, false);
    const PathKind kind = kind_of_path(file);
    if (kind == PathKind::nothing) return std::nullopt;
    if (kind != PathKind::file)  // opening a named pipe would wait for ever
        throw Error(ErrorKind::bad_input, file.string() + " is " + words_for_path(file) + "; allowed is a file" +
                                              is_untouched + "Move it away and put the file back");
    std::ifstream stream(file);
    std::string id_word, generation_word;
    Mark mark;
    stream >> id_word >> mark.id >> generation_word >> mark.generation;
    if (!stream || id_word != "id" || generation_word != "generation" || mark.id.size() != 32)
        throw Error(ErrorKind::bad_input,
                    "the file " + file.string() + " is no id of a store" + is_untouched + advice_to_accept);
    std::string header_word;  // absent in the file of an earlier program
    if (!(stream >> header_word >> mark.header) || header_word != "header") mark.header = 0;
    return mark;
}

/// The file appears whole or not at all.
void StoreIdentity::write_mark(const fs::path& folder, const Mark& mark) {
    const fs::path file = folder / file_name, next = folder / "tmp" / random_name();
    const std::string text = "id " + mark.id + "\ngeneration " + std::to_string(mark.generation) + "\nheader " +
                             std::to_string(mark.header) + "\n";
    try {
        const Descriptor written(::open(next.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0640));
        if (!written) throw_store_error(next, errno);
        give_owner_of(folder, written.get());
        write_all(written.get(), std::as_bytes(std::span(text)), next);
        sync_file(written.get(), next);
        if (::rename(next.c_str(), file.c_str()) != 0) throw_store_error(file, errno);
    } catch (...) {
        ::unlink(next.c_str());
        throw;
    }
    sync_folder(folder);
}

StoreIdentity::StoreIdentity(fs::path folder, Database& database, const std::string& expected_id)
    : folder_(std::move(folder)), database_(database) {
    Mark row;
    database_.read([&](Sql& sql) {
        const std::vector<SqlRow> rows = sql.rows("SELECT id, generation, accepted FROM store");
        if (rows.empty())
            throw Error(ErrorKind::bad_input, "the database in " + folder_.string() +
                                                  " has lost the row of its table " + "store, which holds its id" +
                                                  is_untouched + advice_to_accept);
        row = {rows[0].text(0), rows[0].integer(1)};
        accepted_ = rows[0].integer(2) != 0;
    });
    if (!expected_id.empty() && row.id != expected_id)
        throw Error(ErrorKind::bad_input, "the database in " + folder_.string() + " is of the store " + row.id +
                                              "; allowed is " + expected_id + " ([store] id)" + is_untouched +
                                              "Does [store] folder name the right folder, and is its disk mounted? To "
                                              "serve this store, set id to " +
                                              row.id + " or remove it");
    compare(row);
    id_ = row.id;
    const std::optional<Mark> mark = read_mark(folder_);
    if (!mark) write_mark(folder_, row);
    generation_ = mark ? mark->generation : row.generation;
}

void StoreIdentity::compare(const Mark& row) const {
    const std::optional<Mark> mark = read_mark(folder_);
    const std::string folder = folder_.string();
    const auto stop = [](const std::string& found, const std::string& advice) {
        throw Error(ErrorKind::bad_input, found + is_untouched + advice);
    };
    const auto number = [](std::int64_t value) { return std::to_string(value); };
    if (!mark && row.generation == 0) return;  // a new store, or the first start of a store that had no id
    if (!mark)
        stop("the folder " + folder + " lacks the file " + file_name + " of the store " + row.id +
                 ", to which its database belongs",
             std::string("Is it the right folder, and is its disk mounted? ") + advice_to_accept);
    else if (mark->id != row.id)
        stop("the folder " + folder + " is of the store " + mark->id + "; its database is of the store " + row.id,
             std::string("Put each database into the folder of its own store. ") + advice_to_accept);
    else if (row.generation < mark->generation)
        stop("the database in " + folder + " is older than the store: its generation is " + number(row.generation) +
                 "; that of the folder is " + number(mark->generation),
             advice_for_copy);
    else if (row.generation > mark->generation + 1)
        stop("the folder " + folder + " is older than its database: its generation is " + number(mark->generation) +
                 "; that of the database is " + number(row.generation),
             std::string("Put the newer folder back. ") + advice_to_accept);
}

/// A file that is no id counts as none.
std::optional<StoreIdentity::Mark> StoreIdentity::read_valid_mark(const fs::path& folder) try {
    return read_mark(folder);
} catch (const Error& error) {
    if (error.system_error() != 0) throw;
    return std::nullopt;
}

void StoreIdentity::check_log_belongs(const fs::path& folder, const fs::path& database) {
    std::error_code missing;
    const fs::path log = fs::canonical(database, missing).string() + "-wal";
    if (missing || fs::file_size(log, missing) == 0 || missing) return;
    const std::optional<Mark> mark = read_valid_mark(folder);  // compare() tells of a file that is no id
    const std::optional<std::int64_t> header = DatabaseFiles::number_in(database);
    if (!mark || !header || *header >= mark->header) return;
    throw Error(ErrorKind::bad_input,
                "the database " + database.string() + " is older than the store, and the " + log.filename().string() +
                    " beside it is that of a newer one: generation " + std::to_string(*header) +
                    " stands in its header; that of the store's database is " + std::to_string(mark->header) +
                    " or more" + is_untouched +
                    "Put the newer database back beside its -wal. To work with this one all the same, move that -wal "
                    "and its -shm away and run `hairbaked store accept --config FILE`: the next start then moves files "
                    "that the database does not know to lost+found");
}

/// The next generation is counted from the file's, so a failure to write the file does not let the database run ahead.
/// The checkpoint comes first: so the new generation is in the log, and a database that loses its log is told.
void StoreIdentity::advance() {
    const auto held = database_.lock();  // before mutex_: a writer may hold it and call this
    const std::lock_guard lock(mutex_);
    const Mark next{id_, generation_ + 1, database_.checkpoint()};
    database_.write([&](Sql& sql) {
        sql.run("UPDATE store SET generation = ?, accepted = 0", {next.generation});
        sql.number_file(static_cast<std::int32_t>(next.generation));
    });
    version_ = database_.version();
    record(next);
}

/// The caller holds mutex_.
void StoreIdentity::record(const Mark& mark) try {
    unrecorded_ = mark;
    write_mark(folder_, mark);
    generation_ = mark.generation;
    unrecorded_.reset();
} catch (const std::exception& error) {
    throw Error(ErrorKind::out_of_resources,
                "the file " + (folder_ / file_name).string() +
                    " cannot be written, so a start with an older database would not be noticed: " + error_text(error));
}

void StoreIdentity::check_recorded() {
    const std::lock_guard lock(mutex_);
    if (unrecorded_) record(Mark(*unrecorded_));
}

void StoreIdentity::advance_if_changed() {
    {
        const std::lock_guard lock(mutex_);
        if (version_ == database_.version()) return;
    }
    advance();
}

void StoreIdentity::accept(const fs::path& folder, Database& database) {
    const std::optional<Mark> mark = read_valid_mark(folder);  // a file that is no id is replaced
    Mark both;
    database.write([&](Sql& sql) {
        const std::vector<SqlRow> rows = sql.rows("SELECT id, generation FROM store");
        if (mark) both = *mark;
        if (!mark) both.id = rows.empty() ? random_name() : rows[0].text(0);
        if (!rows.empty()) both.generation = std::max(both.generation, rows[0].integer(1));
        both.generation = std::max<std::int64_t>(both.generation, database.number()) + 1;
        sql.run("DELETE FROM store");
        sql.run("INSERT INTO store(id, generation, accepted) VALUES(?, ?, 1)", {both.id, both.generation});
        sql.number_file(static_cast<std::int32_t>(both.generation));
    });
    both.header = 0;  // that of the file itself
    write_mark(folder, both);
}

}  // namespace hairbake
