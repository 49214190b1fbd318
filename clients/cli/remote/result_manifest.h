// Which files a bake consists of, as its manifest says; nothing in it is trusted.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace hairbake {

struct ListedFile {
    std::string name, digest;
    std::uint64_t bytes = 0;
};

/// The files that the manifest lists. Throws RemoteError(refused) for names that are no plain file names (letters,
/// digits,
/// '.', '_' and '-', no leading '.', not manifest.json), doubles, digests that are none, and more than 4096 files.
std::vector<ListedFile> listed_files(const std::string& manifest);

}  // namespace hairbake
