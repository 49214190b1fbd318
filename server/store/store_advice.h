// What a person can do when the system refuses a call for a file of the store.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace hairbake {

/// Sentences without a full stop at the end. `error` is errno of a call for `path`, a file or folder of the store.
std::string advice_for(const std::filesystem::path& path, int error);

/// The attribute of a file or folder that forbids everybody to change it: 'i' (immutable) or 'a' (append only), as
/// chattr(1) names them. Nothing when there is none, or the file system has no attributes.
std::optional<char> protecting_attribute(const std::filesystem::path& path);

/// The text with "the store" for the path of the store's folder: clients need not know where it is.
std::string without_path(std::string text, const std::filesystem::path& store);

}  // namespace hairbake
