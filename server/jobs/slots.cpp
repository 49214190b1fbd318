#include "server/jobs/slots.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <span>

#include "core/base/digest.h"
#include "core/base/error.h"
#include "server/store/eviction.h"
#include "server/store/refusal.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

/// Where the phases of a stage lie in its whole, by the usual shares of time.
double overall(const std::string& kind, std::string_view phase, double fraction) {
    struct Span {
        std::string_view phase;
        double from, to;
    };
    static constexpr Span transmittance[] = {
        {"read_hair", 0, 0.1}, {"transmittance", 0.1, 0.6}, {"reference", 0.6, 0.85}, {"write", 0.85, 1}};
    static constexpr Span irradiance[] = {{"read_environment", 0, 0.4}, {"irradiance", 0.4, 0.8}, {"write", 0.8, 1}};
    const std::span<const Span> spans = kind == "transmittance" ? std::span<const Span>(transmittance) : irradiance;
    for (const Span& span : spans)
        if (span.phase == phase) return span.from + (span.to - span.from) * std::clamp(fraction, 0.0, 1.0);
    return 0;
}

std::vector<std::string> inputs_of(const ClaimedStage& stage) {
    std::vector<std::string> digests;
    const Json request = Json::parse(stage.request);
    for (const char* field : {"hair", "environment", "occluder", "receiver"})
        if (request.contains(field) && request[field].is_string())
            digests.push_back(request[field].get<std::string>().substr(7));
    return digests;
}

const char* word_for(ErrorKind kind) {
    return kind == ErrorKind::out_of_resources ? "out_of_resources"
           : kind == ErrorKind::bad_input      ? "bad_input"
                                               : "internal";
}

}  // namespace

Slots::Slots(Queue& queue, Runner& runner, Database& database, BlobStore& store, std::uint64_t budget, int slots,
             int threads)
    : queue_(queue), runner_(runner), database_(database), store_(store), budget_(budget), threads_(threads) {
    for (int i = 0; i < slots; ++i) slots_.emplace_back([this] { work(); });
}

Slots::~Slots() = default;

void Slots::work() {
    for (;;) try {
            const std::optional<ClaimedStage> stage = queue_.claim();
            if (!stage) return;
            run_to_the_end(*stage);
            evict(database_, store_, budget_);
        } catch (const std::exception& error) {
            spdlog::error("a worker slot: {}", error.what());  // the database takes nothing
            std::this_thread::sleep_for(std::chrono::seconds(1));
            if (queue_.stopping()) return;
        }
}

/// However a stage ends, it is written down: again and again while the database takes nothing. A stage that a stop
/// leaves `running` is found at the next start.
void Slots::run_to_the_end(const ClaimedStage& stage) {
    StageError failure;
    bool later = false;
    try {
        return run(stage);
    } catch (const Refusal& refusal) {  // memory or descriptors are short
        failure = {"out_of_resources", refusal.what(), ""};
        later = refusal.why() == Refused::busy;
    } catch (const Error& error) {
        failure = {word_for(error.kind()), error.what(), error.field()};
    } catch (const std::exception& error) {
        failure = {"internal", error.what(), ""};
    }
    while (!queue_.stopping()) try {
            if (!later) return queue_.failed(stage, failure);
            spdlog::warn("stage {} starts again: {}", stage.key.substr(0, 12), failure.message);
            std::this_thread::sleep_for(std::chrono::seconds(1));
            return queue_.released(stage);
        } catch (const std::exception& error) {
            spdlog::error("the end of stage {} cannot be written down: {}", stage.key.substr(0, 12), error.what());
            std::this_thread::sleep_for(std::chrono::seconds(1));
        }
}

/// The stage's request with the blobs' paths; a missing input is an Error.
std::string Slots::task_for(const ClaimedStage& stage, const fs::path& folder) {
    Json request = Json::parse(stage.request), names = Json::object();
    for (const char* field : {"hair", "environment", "occluder", "receiver"}) {
        if (!request.contains(field) || !request[field].is_string()) continue;
        const std::string name = request[field].get<std::string>(), digest = name.substr(7);
        if (!store_.size_of(digest))
            throw Error(ErrorKind::bad_input, name + " is no longer stored; send it again", field);
        store_.touch(digest);
        const std::string path = store_.path_of(digest).string();
        request[field] = path;
        names[path] = name;
    }
    names[folder.string()] = "the store";
    return Json{
        {"task", "bake"}, {"request", request}, {"folder", folder.string()}, {"threads", threads_}, {"names", names}}
        .dump();
}

void Slots::run(const ClaimedStage& stage) {
    std::optional<WorkFolder> folder(std::in_place, store_.incoming_folder());
    Task task;
    task.input = task_for(stage, folder->path);
    task.cancel = stage.cancel.get();
    task.progress = [&](std::string_view phase, double fraction) {
        queue_.progress(stage.key, std::string(phase), overall(stage.kind, phase, fraction));
    };
    const Outcome outcome = runner_.run(task);
    spdlog::info("stage {} {} attempt {}: {}", stage.kind, stage.key.substr(0, 12), stage.attempt,
                 outcome.end == Outcome::End::done        ? "done"
                 : outcome.end == Outcome::End::cancelled ? "stopped"
                                                          : outcome.message);
    if (outcome.end != Outcome::End::done) folder.reset();  // what it holds may be what the database lacks
    switch (outcome.end) {
        case Outcome::End::done:
            return store_result(stage, folder);
        case Outcome::End::failed:
            return queue_.failed(stage, {outcome.kind, outcome.message, outcome.field});
        case Outcome::End::died:
            return queue_.died(stage, outcome.message);
        case Outcome::End::cancelled:
            return queue_.released(stage);
    }
}

/// The worker read other bytes than the request names.
void Slots::remove_spoiled_inputs(const std::vector<std::string>& digests) {
    for (const std::string& digest : digests)
        if (digest_of_file(store_.path_of(digest)) != digest) {
            store_.lose(digest, [&](Sql& sql) { queue_.blob_lost(sql, digest); });  // with the facts read from it
            throw Error(ErrorKind::bad_input,
                        "the stored bytes of sha256:" + digest + " were spoiled; send them again");
        }
}

/// A worker is not believed: key and digests are checked before its files become blobs.
void Slots::store_result(const ClaimedStage& stage, std::optional<WorkFolder>& work) {
    const fs::path folder = work->path / "result";
    std::ifstream stream(folder / "manifest.json", std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    const Json manifest = Json::parse(text, nullptr, false);
    if (!manifest.is_object())
        throw Error(ErrorKind::internal, "the worker said that it was done, and its manifest is missing or no JSON");
    if (manifest.at("stages").at(stage.kind).at("key") != stage.core_key) {
        remove_spoiled_inputs(inputs_of(stage));
        throw Error(ErrorKind::internal, "the worker made another key than the daemon: they are not of one version");
    }
    std::vector<StageFile> files;
    for (const Json& entry : manifest.at("files")) {
        const std::string name = entry.at("name").get<std::string>(), digest = entry.at("sha256").get<std::string>();
        if (name.find('/') != std::string::npos || digest_of_file(folder / name) != digest)
            throw Error(ErrorKind::internal, "the worker's file " + name + " is not what its manifest says");
        files.push_back({name, digest, entry.at("bytes").get<std::uint64_t>()});
    }
    const auto held = database_.lock();  // no eviction may come between the blobs and the rows that refer to them
    for (const StageFile& file : files) store_.adopt(folder / file.name, file.sha256);
    work.reset();  // who hears that the stage is done finds nothing of it left over
    queue_.done(stage, files, text);
}

}  // namespace hairbake
