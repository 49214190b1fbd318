// Where a worker writes.
#pragma once

#include <filesystem>
#include <system_error>

#include "server/store/file_system.h"

namespace hairbake {

/// A folder of its own in `parent` that goes away with its owner.
class WorkFolder {
public:
    explicit WorkFolder(const std::filesystem::path& parent) : path(parent / random_name()) { make_folder(path); }
    ~WorkFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
    }
    WorkFolder(const WorkFolder&) = delete;
    WorkFolder& operator=(const WorkFolder&) = delete;

    const std::filesystem::path path;
};

}  // namespace hairbake
