#include "clients/cli/remote/upload_memory.h"

#include <cstdlib>
#include <fstream>

#include "clients/cli/remote/server.h"
#include "core/base/digest.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

fs::path cache_folder() {
    const char* const cache = std::getenv("XDG_CACHE_HOME");
    if (cache && *cache == '/') return fs::path(cache) / "hairbake/uploads";
    const char* const home = std::getenv("HOME");
    return home && *home == '/' ? fs::path(home) / ".cache/hairbake/uploads" : fs::path();
}

}  // namespace

UploadMemory::UploadMemory(const std::string& url, const std::string& digest) {
    const fs::path folder = cache_folder();
    if (!folder.empty()) file_ = folder / Digest().add(url + " " + digest).hex();
}

std::string UploadMemory::recall() const {
    std::string id;
    std::ifstream stream(file_);
    if (!file_.empty() && stream) stream >> id;
    return is_id(id) ? id : "";
}

void UploadMemory::keep(const std::string& id) const noexcept {
    if (file_.empty()) return;
    std::error_code ignored;
    fs::create_directories(file_.parent_path(), ignored);
    std::ofstream(file_) << id << '\n';
}

void UploadMemory::forget() const noexcept {
    std::error_code ignored;
    if (!file_.empty()) fs::remove(file_, ignored);
}

}  // namespace hairbake
