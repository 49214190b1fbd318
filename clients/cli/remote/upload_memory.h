// Remembers unfinished uploads between processes.
#pragma once

#include <filesystem>
#include <string>

namespace hairbake {

/// The id of the unfinished upload of one file to one server. If the file cannot be written, the id is not kept.
class UploadMemory {
public:
    UploadMemory(const std::string& url, const std::string& digest);

    /// The id; empty when there is none.
    std::string recall() const;
    void keep(const std::string& id) const noexcept;
    void forget() const noexcept;

private:
    std::filesystem::path file_;  ///< empty without a home
};

}  // namespace hairbake
