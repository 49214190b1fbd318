// What BlobStore does at boot.
#include <algorithm>
#include <unordered_map>
#include <utility>

#include "core/base/error.h"
#include "server/store/blob_store.h"
#include "server/store/database.h"
#include "server/store/input_text.h"
#include "server/store/removal_log.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

/// Whether file_system.h's random_name() makes such names: of bodies, results and work folders.
bool is_random_name(const std::string& name) {
    return name.size() == 32 && name.find_first_not_of("0123456789abcdef") == std::string::npos;
}

/// What is in the folders of blobs/: files, and whatever else is in the place of one.
std::vector<fs::path> entries_in(const fs::path& folder) {
    std::vector<fs::path> entries;
    for (fs::recursive_directory_iterator entry(folder), end; entry != end; ++entry) {
        const bool is_folder = entry->symlink_status().type() == fs::file_type::directory;
        if (is_folder && entry.depth() == 0) continue;
        entries.push_back(entry->path());
        if (is_folder) entry.disable_recursion_pending();
    }
    return entries;
}

}  // namespace

LostBlobs BlobStore::recover(const std::set<std::string>& spared, bool may_miss_all) {
    std::unordered_map<std::string, std::int64_t> rows;
    database_.read([&](Sql& sql) {
        for (const SqlRow& row : sql.rows("SELECT sha256, bytes FROM blobs")) rows[row.text(0)] = row.integer(1);
    });
    const std::size_t known = rows.size();
    std::vector<fs::path> others;
    bool some_have_files = false;
    for (const fs::path& file : entries_in(folder_ / "blobs")) {
        const auto row = rows.find(file.filename().string());
        const std::optional<FileFacts> facts = facts_of(file);
        some_have_files |= row != rows.end() && facts;
        if (row != rows.end() && facts && facts->bytes == row->second)
            rows.erase(row);  // as it should be
        else
            others.push_back(file);
    }
    if (known > 0 && !some_have_files && !may_miss_all)
        throw Error(ErrorKind::bad_input,
                    "the folder " + (folder_ / "blobs").string() + " holds none of the " + std::to_string(known) +
                        " files that the database knows. Nothing was changed or removed. Is its disk mounted? Put the "
                        "files back. To go on without them, run `hairbaked store accept --config FILE`: results are "
                        "then baked again, and inputs must "
                        "be sent again");
    sweep_incoming(spared);
    clear_unknown_files(others);
    std::vector<std::string> missing;
    for (const auto& [digest, bytes] : rows) missing.push_back(digest);
    return missing.empty() ? LostBlobs() : forget_missing(missing);
}

void BlobStore::log_lost_found() const { log_held(lost_found_.held(), folder_ / "lost+found"); }

LostBlobs BlobStore::forget_missing(const std::vector<std::string>& digests) {
    LostBlobs lost;
    forget([&](Sql& sql) {
        lost = {};
        for (const std::string& digest : digests)
            if (std::optional<std::string> input = input_text(sql, digest))
                lost.inputs.push_back(std::move(*input));
            else
                ++lost.results;
        return digests;
    });
    std::sort(lost.inputs.begin(), lost.inputs.end());
    return lost;
}

/// Files of other names are not ours and stay.
void BlobStore::sweep_incoming(const std::set<std::string>& spared) {
    FileCount removed;
    for (const fs::directory_entry& entry : fs::directory_iterator(incoming_folder()))
        if (const std::string name = entry.path().filename().string(); is_random_name(name) && !spared.count(name))
            remove_tree_counted(entry.path(), removed);
    log_removal(removed, "bodies and results that were being written when the daemon ended; none was acknowledged");
}

/// Files without a row, and files of another size than their row's. A file that is younger than the removal of its blob
/// came after it, so it is kept.
void BlobStore::clear_unknown_files(const std::vector<fs::path>& files) {
    FileCount removed, moved;
    for (const fs::path& file : files) {
        double removal = 0;
        database_.read([&](Sql& sql) {
            const auto rows = sql.rows("SELECT time FROM removals WHERE sha256 = ?", {file.filename().string()});
            if (!rows.empty()) removal = rows[0].number(0);
        });
        const std::optional<FileFacts> facts = facts_of(file);
        if (facts && static_cast<double>(facts->ctime_ns) * 1e-9 < removal)
            remove_counted(file, removed);
        else
            put_aside(file, moved);
    }
    log_removal(removed, "their blobs were removed before the daemon ended");
    log_move(moved, lost_folder(), "the database does not know these files, their size is wrong, or they are no files");
}

}  // namespace hairbake
