// How the worker pool checks a result and stores it.
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <system_error>

#include "core/base/digest.h"
#include "core/base/error.h"
#include "core/base/json_nesting.h"
#include "server/jobs/queue.h"
#include "server/jobs/stage_outcome.h"
#include "server/jobs/work_folder.h"
#include "server/jobs/worker_pool.h"
#include "server/store/blob_store.h"
#include "server/store/database.h"
#include "server/store/room.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
constexpr std::size_t longest_manifest = 512 << 10;  // bytes; the longest ones have some 50 kB

/// A missing file in a folder that is there has not its digest, nor has a folder or a pipe.
/// Throws Error with the system's error number when the file cannot be read.
bool has_its_digest(const fs::path& file, const std::string& digest) try {
    const PathKind kind = kind_of_path(file);
    return kind != PathKind::folder && kind != PathKind::other && digest_of_file(file) == digest;
} catch (const Error& error) {
    if (error.system_error() == ENOENT && fs::is_directory(file.parent_path())) return false;
    throw;
}

bool is_link(const fs::path& path) {
    std::error_code error;
    return fs::is_symlink(fs::symlink_status(path, error));
}

}  // namespace

/// Forgets inputs that are missing or whose stored bytes do not have their digest.
/// Throws Error(bad_input) when there is one.
/// Throws Error with the system's error number when one cannot be read now.
void WorkerPool::remove_spoiled_inputs(const std::vector<std::string>& digests) {
    for (const std::string& digest : digests)
        if (!has_its_digest(store_.path_of(digest), digest)) {
            // and the facts read from it
            const LostBlob lost = store_.lose(digest, [&](Sql& sql) { queue_.blob_lost(sql, digest); });
            throw Error(ErrorKind::bad_input, lost.what());
        }
}

/// The text of the result's manifest.
/// Throws WrongResult when it is missing, no JSON, or of another stage key.
/// Throws Error with the system's error number when the work folder is gone or the file cannot be opened.
/// Throws Error(bad_input) when it is of another stage key because an input was spoiled.
std::string WorkerPool::checked_manifest(const ClaimedStage& stage, const fs::path& folder) {
    const fs::path file = folder / "manifest.json";
    if (const PathKind kind = kind_of_path(file); kind == PathKind::folder || kind == PathKind::other)
        throw WrongResult("the worker's manifest is " + words_for_path(file));
    std::ifstream stream(file, std::ios::binary);
    if (!stream && !(errno == ENOENT && fs::is_directory(folder.parent_path())))
        throw Error(ErrorKind::internal, file.string() + ": " + std::generic_category().message(errno), {}, errno);
    std::string text(longest_manifest + 1, '\0');
    stream.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(stream.gcount()));
    if (text.size() > longest_manifest || nested_deeper_than(text, deepest_json))
        throw WrongResult("the worker's manifest is longer than " + std::to_string(longest_manifest) +
                          " bytes, or nested deeper than " + std::to_string(deepest_json) + " levels");
    const Json manifest = Json::parse(text, nullptr, false);
    if (!manifest.is_object()) throw WrongResult("the worker reported success, but its manifest is missing or no JSON");
    if (manifest.at("stages").at(stage.kind).at("key") != stage.core_key) {
        remove_spoiled_inputs(input_digests(stage));
        throw WrongResult("the worker made another key than the daemon");
    }
    return text;
}

/// Throws ResultTooLarge when the whole budget is less than the result.
void WorkerPool::check_fits(const std::vector<StageFile>& files, const fs::path& folder) {
    std::map<std::string, std::uint64_t> sizes;  // by digest: equal files are one blob
    for (const StageFile& file : files) sizes[file.sha256] = fs::file_size(folder / file.name);
    std::uint64_t bytes = 0;
    for (const auto& [digest, size] : sizes) bytes += size;
    if (bytes > room_.budget())
        throw ResultTooLarge("the result of " + std::to_string(bytes) +
                             " bytes is larger than the whole store may be: " + "budget_mb is " +
                             std::to_string(room_.budget() >> 20) + "; ask for a smaller result, or raise budget_mb");
}

/// Bytes by which the store grows with a result.
std::uint64_t WorkerPool::new_bytes(const std::vector<StageFile>& files, const fs::path& folder) {
    std::uint64_t bytes = 0;
    for (const StageFile& file : files)
        if (!store_.size_of(file.sha256)) bytes += fs::file_size(folder / file.name);
    return bytes;
}

/// A worker is not believed: key and digests are checked before its files become blobs.
/// Throws Refusal(full) when there is no room for the result now.
void WorkerPool::store_result(const ClaimedStage& stage, std::unique_ptr<WorkFolder> work) {
    const fs::path folder = work->path() / "result";
    const std::string manifest = checked_manifest(stage, folder);
    const Json described = Json::parse(manifest);
    std::vector<StageFile> files;
    for (const Json& entry : described.at("files")) {
        const std::string name = entry.at("name").get<std::string>(), digest = entry.at("sha256").get<std::string>();
        if (name.find('/') != std::string::npos || is_link(folder / name) || !has_its_digest(folder / name, digest))
            throw WrongResult("the worker's file " + name + " is not as its manifest describes it");
        files.push_back({name, digest, entry.at("bytes").get<std::uint64_t>()});
    }
    check_fits(files, folder);
    const auto held = database_.lock();  // no eviction may come between the blobs and the rows that refer to them
    room_.make_room(new_bytes(files, folder));
    for (const StageFile& file : files) store_.adopt(folder / file.name, file.sha256, Origin::made);
    work.reset();  // before anybody learns that the stage is done
    queue_.done(stage, files, manifest);
}

}  // namespace hairbake
