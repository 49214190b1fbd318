// Remembers unfinished uploads between processes.
#pragma once

#include <filesystem>
#include <string>

namespace hairbake {

/// The id of the unfinished upload of one file to one server. Where nothing can be written, nothing is remembered.
class UploadMemory {
public:
    UploadMemory(const std::string& url, const std::string& digest);

    /// Empty when there is none.
    std::string recall() const;
    void keep(const std::string& id) const noexcept;
    void forget() const noexcept;

private:
    std::filesystem::path file_;  ///< empty without a home
};

}  // namespace hairbake
