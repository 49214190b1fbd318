// How the worker pool checks a result and stores it.
#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "core/base/digest.h"
#include "core/base/error.h"
#include "core/base/json_nesting.h"
#include "server/jobs/queue.h"
#include "server/jobs/stage_outcome.h"
#include "server/jobs/work_folder.h"
#include "server/jobs/worker_pool.h"
#include "server/store/blob_store.h"
#include "server/store/database.h"
#include "server/store/file_system.h"
#include "server/store/refusal.h"
#include "server/store/room.h"
#include "server/store/store_advice.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
constexpr std::size_t most_remembered = 1000;     // results that found no room
constexpr std::uint64_t least_growth = 64 << 10;  // of the free bytes of a disk; the database takes and gives less
constexpr const char* waiting_bakes =             // of a stage
    "SELECT m.bake FROM bake_stages m JOIN bakes b ON b.seq = m.bake "
    "WHERE m.stage = ? AND b.state IN ('queued', 'running')";
constexpr const char* needed_bytes =  // by a bake, without a list of digests
    "SELECT sum(bytes) FROM blobs WHERE sha256 IN ("
    "SELECT i.sha256 FROM bake_stages m JOIN stage_inputs i USING(stage) WHERE m.bake = ?1 "
    "UNION SELECT f.sha256 FROM bake_stages m JOIN stages d ON d.key = m.stage JOIN stage_files f USING(stage) "
    "WHERE m.bake = ?1 AND d.state = 'done') "
    "AND sha256 NOT IN (SELECT value FROM json_each(?2))";
constexpr std::size_t longest_manifest = 512 << 10;  // bytes; the longest ones have some 50 kB

/// A missing file in a folder that is there has not its digest, nor has a folder or a pipe.
/// Throws Error with the system's error number when the file cannot be read.
bool has_its_digest(const fs::path& file, const std::string& digest) try {
    const PathKind kind = kind_of_path(file);
    return kind != PathKind::folder && kind != PathKind::other && digest_of_file(file) == digest;
} catch (const Error& error) {
    if (error.system_error() == ENOENT && kind_of_path(file.parent_path()) == PathKind::folder) return false;
    throw Error(error.kind(), error.what() + (". " + advice_for(file, error.system_error())), error.field(),
                error.system_error());
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
    if (!stream && !(errno == ENOENT && kind_of_path(folder.parent_path()) == PathKind::folder))
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

/// Bytes of what must be stored beside the result until the stage's bakes end: of one bake the inputs and the results
/// of its stages that are done. Of several bakes the smallest sum counts; the search ends at one of at most `enough`.
std::uint64_t WorkerPool::bytes_beside(const ClaimedStage& stage, const Sizes& sizes, std::uint64_t enough) {
    Json result = Json::array();
    for (const auto& [digest, size] : sizes) result.push_back(digest);
    const std::string digests = result.dump();
    std::optional<std::uint64_t> least;
    database_.read([&](Sql& sql) {
        sql.each(waiting_bakes, {stage.key}, [&](const SqlRow& bake) {
            const SqlRow sum = sql.rows(needed_bytes, {bake.integer(0), digests}).at(0);
            const auto bytes = static_cast<std::uint64_t>(sum.integer(0));
            least = std::min(least.value_or(bytes), bytes);
            return *least > enough;
        });
    });
    return least.value_or(0);
}

/// Throws ResultTooLarge when the whole budget is less than the result, or less than the result and what its bake needs
/// beside it.
void WorkerPool::check_fits(const ClaimedStage& stage, const Sizes& sizes) {
    std::uint64_t bytes = 0;
    for (const auto& [digest, size] : sizes) bytes += size;
    const std::uint64_t budget = room_.budget();
    const auto refuse = [&](const std::string& found) {
        throw ResultTooLarge(found + ": budget_mb is " + std::to_string(budget >> 20) +
                             "; ask for a smaller result, or raise budget_mb");
    };
    const std::string result = "the result of " + std::to_string(bytes) + " bytes";
    if (bytes > budget) refuse(result + " is larger than the whole store may be");
    if (room_.fits(new_bytes(sizes))) return;
    const std::uint64_t beside = bytes_beside(stage, sizes, budget - bytes);
    if (bytes + beside > budget)
        refuse(result + ", and inputs and other results of the same bake of " + std::to_string(beside) +
               " bytes, are together " + std::to_string(bytes + beside) + " bytes, more than the whole store may be");
}

/// Bytes by which the store grows with a result.
std::uint64_t WorkerPool::new_bytes(const Sizes& sizes) {
    std::uint64_t bytes = 0;
    for (const auto& [digest, size] : sizes)
        if (!store_.size_of(digest)) bytes += size;
    return bytes;
}

/// A stage whose result found no room is not baked again before there is room for it.
/// Throws ResultTooLarge.
/// Throws Refusal(full or busy).
/// Throws Error(out_of_resources) while the disk has no more free than when the result found no room.
void WorkerPool::check_known_result(const ClaimedStage& stage) {
    Waiting known;
    {
        const std::lock_guard lock(mutex_);
        const auto found = waiting_.find(stage.key);
        if (found == waiting_.end()) return;
        known = found->second;
    }
    if (known.disk_free && room_.disk_free() < *known.disk_free + least_growth)
        throw_store_error(store_.incoming_folder() / "result", ENOSPC);
    if (!known.sizes.empty()) {
        check_fits(stage, known.sizes);
        require_room(stage, new_bytes(known.sizes));
    }
    remember(stage, {known.sizes, std::nullopt});
}

/// Throws Refusal(full or busy) when there is no room, also if later bakes gave way.
void WorkerPool::require_room(const ClaimedStage& stage, std::uint64_t bytes) {
    const auto held = database_.lock();
    try {
        room_.require_room(bytes);
    } catch (const Refusal& refusal) {
        if (refusal.why() != Refused::full || !queue_.can_give_way(stage.key, room_.lacking(bytes))) throw;
    }
}

/// With database_.lock() held.
void WorkerPool::make_room(const ClaimedStage& stage, const Sizes& sizes) {
    const std::uint64_t bytes = new_bytes(sizes);
    const auto make_room_at_last = [&] {
        if (!queue_.make_others_give_way(stage.key, room_.lacking(bytes))) return false;
        room_.make_room(bytes);
        return true;
    };
    try {
        room_.make_room(bytes);
    } catch (const Refusal& refusal) {
        if (refusal.why() == Refused::full && make_room_at_last()) return;
        remember(stage, {sizes, std::nullopt});
        throw;
    }
}

/// The worker's files are removed already. A number that is known stays: then nothing was baked.
void WorkerPool::note_full_disk(const ClaimedStage& stage) try {
    const std::uint64_t free = room_.disk_free();
    Waiting known;
    {
        const std::lock_guard lock(mutex_);
        if (const auto found = waiting_.find(stage.key); found != waiting_.end()) known = found->second;
    }
    if (!known.disk_free) remember(stage, {known.sizes, free});
} catch (const Error&) {  // the disk cannot be looked at: the stage is baked again
}

void WorkerPool::remember(const ClaimedStage& stage, Waiting waiting) {
    const std::lock_guard lock(mutex_);
    if (waiting_.size() >= most_remembered) waiting_.clear();  // they are of cancelled bakes; the price is one bake
    waiting_[stage.key] = std::move(waiting);
}

void WorkerPool::forget_result(const ClaimedStage& stage) {
    const std::lock_guard lock(mutex_);
    waiting_.erase(stage.key);
}

/// A worker is not believed: key and digests are checked before its files become blobs.
/// Throws Refusal(full) when there is no room for the result now.
void WorkerPool::store_result(const ClaimedStage& stage, std::unique_ptr<WorkFolder> work) {
    const fs::path folder = work->path() / "result";
    const std::string manifest = checked_manifest(stage, folder);
    const Json described = Json::parse(manifest);
    std::vector<StageFile> files;
    Sizes sizes;
    for (const Json& entry : described.at("files")) {
        const std::string name = entry.at("name").get<std::string>(), digest = entry.at("sha256").get<std::string>();
        if (name.find('/') != std::string::npos || is_link(folder / name) || !has_its_digest(folder / name, digest))
            throw WrongResult("the worker's file " + name + " is not as its manifest describes it");
        files.push_back({name, digest, entry.at("bytes").get<std::uint64_t>()});
        sizes[digest] = static_cast<std::uint64_t>(facts_of(folder / name).value_or(FileFacts{}).bytes);
    }
    check_fits(stage, sizes);
    const auto held = database_.lock();  // no eviction may come between the blobs and the rows that refer to them
    make_room(stage, sizes);
    for (const StageFile& file : files) store_.adopt(folder / file.name, file.sha256, Origin::made);
    work.reset();  // before anybody learns that the stage is done
    queue_.done(stage, files, manifest);
}

}  // namespace hairbake
