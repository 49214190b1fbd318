#include "server/store/database_errors.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <sqlite3.h>

#include <cerrno>
#include <string>

#include "core/base/error.h"
#include "server/store/database.h"
#include "server/store/database_files.h"
#include "server/store/disk_reserve.h"
#include "server/store/file_system.h"
#include "server/store/store_advice.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

int primary_code(const SQLite::Exception& error) { return error.getErrorCode() & 0xff; }

std::string locked(const fs::path& file) {
    return "another program holds the lock of the database " + file.string() +
           ". Let it end its transaction, or end it (`fuser " + file.string() +
           "` lists the programs that have it open)";
}

}  // namespace

bool is_locked(const SQLite::Exception& error) {
    return primary_code(error) == SQLITE_BUSY || primary_code(error) == SQLITE_LOCKED;
}

void throw_failed_statement(const SQLite::Exception& error, const fs::path& file) {
    const int code = primary_code(error);
    const std::string name = "the database " + file.string();
    if (is_locked(error)) throw Refusal(Refused::busy, locked(file) + "; nothing is written. Try again later");
    if (code == SQLITE_FULL)
        throw Error(ErrorKind::out_of_resources, name + " cannot grow: its disk is full. " + advice_for(file, ENOSPC),
                    {}, ENOSPC);
    if (code == SQLITE_READONLY || code == SQLITE_IOERR || code == SQLITE_CANTOPEN)
        throw Error(ErrorKind::out_of_resources,
                    name + " cannot be written: " + error.what() +
                        ". Check that its disk has room and can be written, and that the "
                        "daemon's user may write the file and its folder",
                    {}, code == SQLITE_READONLY ? EROFS : EIO);
    if (code == SQLITE_CORRUPT || code == SQLITE_NOTADB)
        throw SpoiledDatabase(Refused::busy, name + " is spoiled: " + error.what() + ". Stop the daemon if it runs. " +
                                                 advice_for_broken_database);
    throw Error(ErrorKind::internal, "the database: " + std::string(error.what()));
}

void throw_if_system_failed(const SQLite::Exception& error, const fs::path& file) {
    const int code = primary_code(error);
    const std::string found = "the database " + file.string() + " cannot be opened: " + error.what();
    if (is_locked(error))
        throw Error(ErrorKind::out_of_resources, locked(file) + ". Nothing was changed or removed. Start again then");
    if (code == SQLITE_FULL || (code == SQLITE_IOERR && free_bytes(file.parent_path()) < DiskReserve::enough))
        throw_disk_full(file);
    if (code == SQLITE_IOERR)
        throw Error(ErrorKind::out_of_resources,
                    found + ". Nothing was changed or removed. Check the disk, and the system's log");
    if (code == SQLITE_NOMEM) throw Error(ErrorKind::out_of_resources, found);
    if (code == SQLITE_CANTOPEN || code == SQLITE_READONLY || code == SQLITE_PERM)
        throw Error(ErrorKind::bad_input,
                    found +
                        ". Nothing was changed or removed. Check that the daemon's user may read and write it and "
                        "its folder, and that no other program has it open");
}

}  // namespace hairbake
