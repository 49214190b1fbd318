// The folder of one store: who works on it, and whether it is one.
//
//   lock          locked by the daemon that works on the store; so is the folder itself
//   store-id      id and generation of the store (store_identity.h)
//   hairbake.db   the database, with -wal and -shm
//   blobs/        files by digest (blob_store.h)
//   uploads/      unfinished uploads
//   tmp/          bodies and results that are being written
//   lost+found/   files that the database does not know (lost_found.h)
//   reserve       space for deletions on a full disk (disk_reserve.h)
#pragma once

#include <filesystem>
#include <string>

#include "server/store/database.h"
#include "server/store/file_system.h"
#include "server/store/pinned_files.h"

namespace hairbake {

/// For what a store is opened: `accept` makes no new one.
enum class StoreUse { serve, accept };

/// Locked by this process until the destructor. Immutable, so thread-safe.
class StoreFolder {
public:
    /// Makes the folder and its parts where they are missing, and locks it. Changes nothing when it throws, but for an
    /// empty folder and the file `lock`.
    ///
    /// `expected_id` is the id that the settings give, or empty. With one, no new store is made.
    /// Throws Error(usage) when another daemon works on the store.
    /// Throws Error(bad_input), telling what to do, when the database is missing or empty and the folder holds anything
    /// else, when a part of the store is on another device, when this process may not read and write a part, and with
    /// StoreUse::accept when the folder holds no store.
    StoreFolder(std::filesystem::path folder, const std::string& expected_id, StoreUse use = StoreUse::serve);

    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path database() const { return path_ / "hairbake.db"; }

    /// What the database of this store asks before it changes its file. They refer to this object.
    DatabaseHooks hooks() const;
    /// The same for StoreIdentity::accept(), which takes an older database.
    DatabaseHooks hooks_to_accept() const;

    /// Throws Refusal(busy) when the folder or a part of it was moved, deleted or replaced.
    void check_in_place() const { pins_.check(); }

    /// Throws Error(out_of_resources), naming the folder, the reason and what to do, when this process may not read and
    /// write one of the folders of files.
    void check_usable() const;

private:
    void check_database_file() const;
    void check_before_new_database() const;
    void check_before_upgrade(int version) const;
    void check_parts() const;
    void make_parts() const;

    std::filesystem::path path_;
    std::string expected_id_;
    StoreUse use_;
    Descriptor folder_lock_, lock_;
    PinnedFiles pins_;
};

}  // namespace hairbake
