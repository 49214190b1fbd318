// Whether this process may read and write the files of a store, and to whom new files belong.
#pragma once

#include <filesystem>

namespace hairbake {

/// Nothing happens when nothing is at `path`. `store` is the store's folder, for the advice.
/// Throws Error(bad_input) with the path, the system's reason and what to do when this process may not read the file or
/// folder, or, with `to_write`, may not write it. A folder must be searchable, too.
void check_access(const std::filesystem::path& store, const std::filesystem::path& path, bool to_write = true);

/// Gives the open file or folder the owner and group of `model`. Root alone can do that; for others, and where root
/// lacks the right, nothing happens. So a command of root leaves no file that the daemon cannot read.
void give_owner_of(const std::filesystem::path& model, int descriptor);

/// Makes the folder and its missing parents.
/// Throws Error(bad_input) with the path, the reason and what to do when that is forbidden or when a file is in the
/// way.
/// Throws as throw_store_error() otherwise.
void make_store_folder(const std::filesystem::path& store, const std::filesystem::path& folder);

}  // namespace hairbake
