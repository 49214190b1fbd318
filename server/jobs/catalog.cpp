#include "server/jobs/catalog.h"

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/short_text.h"
#include "server/jobs/page.h"
#include "server/jobs/runner.h"
#include "server/jobs/task_follower.h"
#include "server/jobs/time_text.h"
#include "server/jobs/work_folder.h"
#include "server/jobs/worker_trial.h"
#include "server/store/blob_store.h"
#include "server/store/database.h"
#include "server/store/refusal.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

// Columns: seq, sha256, facts, thumbnail, created, bytes.
constexpr const char* input_columns =
    "SELECT i.seq, i.sha256, i.facts, i.thumbnail, i.created, b.bytes FROM inputs i JOIN blobs b USING(sha256) ";

Json entry(const std::string& kind, const SqlRow& row) {
    const std::string self = "/v1/" + kind + "s/" + row.text(1);
    Json json{{"id", row.text(1)}, {"kind", kind}, {"bytes", row.integer(5)}, {"created", time_text(row.number(4))}};
    json["facts"] = Json::parse(row.text(2));
    json["links"] = {{"self", self}, {"blob", "/v1/blobs/" + row.text(1)}};
    if (!row.null(3)) json["links"]["thumbnail"] = self + "/thumbnail.png";
    return json;
}

[[noreturn]] void refuse_unknown(const std::string& kind, const std::string& digest) {
    throw Refusal(Refused::not_found, "there is no " + kind + " " + shortened(digest, 64));
}

[[noreturn]] void refuse_for_now(const std::string& reason) {
    throw Refusal(Refused::busy, "the file cannot be read now: " + reason);
}

/// Throws what the failed inspection means to the client. A file that kills every worker is the file's fault.
[[noreturn]] void refuse_outcome(const Outcome& outcome) {
    if (outcome.end == Outcome::End::trouble) refuse_for_now(outcome.message);
    if (outcome.end == Outcome::End::died && outcome.from_outside)
        refuse_for_now(outcome.message + ": the machine is short of memory, or another program ends the workers");
    const bool is_ours = outcome.kind == ErrorKind::out_of_resources || outcome.kind == ErrorKind::internal;
    if (outcome.end == Outcome::End::failed && is_ours) throw Error(outcome.kind, outcome.message);
    throw Refusal(Refused::unprocessable, outcome.message, "sha256");
}

std::string digest_of_thumbnail(const fs::path& picture) try {
    if (!is_plain_file(picture)) refuse_for_now("the thumbnail that the worker made is gone or no file");
    return digest_of_file(picture);
} catch (const Error&) {
    refuse_for_now("the thumbnail that the worker made is gone");
}

}  // namespace

Catalog::Catalog(Database& database, BlobStore& store, Runner& runner)
    : database_(database), store_(store), runner_(runner) {}

Catalog::Added Catalog::add(const std::string& kind, const std::string& digest) {
    if (!store_.size_of(digest))
        throw Refusal(Refused::unprocessable, "sha256:" + shortened(digest, 64) + " is not stored; send it first",
                      "sha256");
    store_.touch(digest);
    bool known = false;
    database_.read([&](Sql& sql) {
        known = !sql.rows("SELECT 1 FROM inputs WHERE kind = ? AND sha256 = ?", {kind, digest}).empty();
    });
    if (!known) inspect(kind, digest);
    return {get(kind, digest), known};
}

void Catalog::inspect(const std::string& kind, const std::string& digest) {
    if (!readers_.try_acquire_for(std::chrono::seconds(60)))
        throw Refusal(Refused::busy, "the facts of " + std::to_string(most_readers) +
                                         " files are being read, and no more are read at once; try again in 5 s");
    struct Release {
        std::counting_semaphore<2>& readers;
        ~Release() { readers.release(); }
    } const release{readers_};
    const std::string path = store_.path_of(digest).string();
    const WorkFolder folder(store_.incoming_folder(), Json{{"task", "inspect"},
                                                           {"kind", kind},
                                                           {"file", path},
                                                           {"threads", 1},
                                                           {"names", {{path, "sha256:" + digest}}}}
                                                          .dump());
    Outcome outcome = run(folder);
    if (outcome.end == Outcome::End::died) outcome = run(folder);  // a chance may have killed it, not the file
    if (outcome.end == Outcome::End::died)
        outcome = explain_death(std::move(outcome), runner_, store_.incoming_folder(), [] { return Wish::go_on; });
    if (outcome.end != Outcome::End::done) refuse_outcome(outcome);
    const fs::path picture = folder.path() / "thumbnail.png";
    const std::string thumbnail = digest_of_thumbnail(picture);
    const auto held = database_.lock();  // no eviction may come between blob and row
    if (!store_.size_of(digest))
        throw Refusal(Refused::conflict, "the file was deleted while it was read; send it again", "sha256");
    store_.adopt(picture, thumbnail, Origin::made);
    database_.write([&](Sql& sql) {
        sql.run("INSERT OR IGNORE INTO inputs(kind, sha256, facts, thumbnail, created) VALUES(?, ?, ?, ?, ?)",
                {kind, digest, outcome.facts, thumbnail, now()});
    });
}

Outcome Catalog::run(const WorkFolder& folder) try {
    return follow_task(
        runner_, runner_.start(folder.path()), folder, [] { return Wish::go_on; }, [](std::string_view, double) {});
} catch (const Error& error) {
    refuse_for_now(error.what());
}

std::string Catalog::get(const std::string& kind, const std::string& digest) {
    std::string answer;
    database_.read([&](Sql& sql) {
        const auto rows = sql.rows(std::string(input_columns) + "WHERE kind = ? AND sha256 = ?", {kind, digest});
        if (!rows.empty()) answer = entry(kind, rows[0]).dump();
    });
    if (answer.empty()) refuse_unknown(kind, digest);
    return answer;
}

std::string Catalog::list(const std::string& kind, std::int64_t cursor, int limit) {
    Page page(kind + "s", limit);
    database_.read([&](Sql& sql) {
        sql.each(std::string(input_columns) + "WHERE kind = ? AND seq < ? ORDER BY seq DESC LIMIT ?",
                 {kind, cursor, std::int64_t(limit) + 1}, [&](const SqlRow& row) {
                     if (!page.has_room()) return false;
                     page.add(entry(kind, row).dump(), std::to_string(row.integer(0)));
                     return true;
                 });
    });
    return page.take_text();
}

std::string Catalog::thumbnail(const std::string& kind, const std::string& digest) {
    std::string found;
    database_.read([&](Sql& sql) {
        const auto rows = sql.rows("SELECT thumbnail FROM inputs WHERE kind = ? AND sha256 = ?", {kind, digest});
        if (!rows.empty()) found = rows[0].text(0);
    });
    if (found.empty()) refuse_unknown(kind, digest);
    return found;
}

}  // namespace hairbake
