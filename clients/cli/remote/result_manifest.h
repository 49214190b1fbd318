// The files of a bake as its manifest lists them. The manifest is not trusted: every entry is checked.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace hairbake {

struct ListedFile {
    std::string name, digest;
    std::uint64_t bytes = 0;
};

/// The files that the manifest lists. A name must be a plain file name (letters, digits, '.', '_' and '-', no leading
/// '.', not manifest.json) and must be listed once. At most 4096 files are allowed.
/// Throws RemoteError(refused) for a wrong name, a wrong digest or too many files.
std::vector<ListedFile> listed_files(const std::string& manifest);

}  // namespace hairbake
