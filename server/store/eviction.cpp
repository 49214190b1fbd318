#include "server/store/eviction.h"

#include <algorithm>
#include <string>
#include <vector>

#include "server/store/blob_store.h"
#include "server/store/database.h"
#include "server/store/pruning.h"
#include "server/store/removal_log.h"

namespace hairbake {
namespace {

const std::string live_bake_of_stage =
    "EXISTS(SELECT 1 FROM bake_stages m CROSS JOIN bakes b ON b.seq = m.bake WHERE m.stage = s.key AND "
    "b.state IN ('queued', 'running'))";

/// Of the blob `bl`: somebody else than a stage that wrote it needs it.
const std::string is_needed =
    "(EXISTS(SELECT 1 FROM sent_blobs t WHERE t.sha256 = bl.sha256) OR "
    "EXISTS(SELECT 1 FROM stage_inputs t WHERE t.sha256 = bl.sha256) OR "
    "EXISTS(SELECT 1 FROM inputs i WHERE i.sha256 = bl.sha256) OR "
    "EXISTS(SELECT 1 FROM inputs i WHERE i.thumbnail = bl.sha256) OR "
    "EXISTS(SELECT 1 FROM names n WHERE n.sha256 = bl.sha256))";

/// Most blobs or stages that one ranking of all gives. The writer's lock is held while they are ranked.
constexpr std::int64_t ranked_at_once = 1000;

std::vector<std::string> texts(const std::vector<SqlRow>& rows) {
    std::vector<std::string> found;
    for (const SqlRow& row : rows) found.push_back(row.text(0));
    return found;
}

/// The least recently used stored stages that no live bake needs, oldest first.
std::vector<std::string> oldest_stages(Sql& sql) {
    return texts(
        sql.rows("SELECT s.key FROM stages s WHERE s.state = 'done' AND NOT (" + live_bake_of_stage +
                     ") ORDER BY (SELECT max(bl.used) FROM stage_files f JOIN blobs bl USING(sha256) WHERE f.stage = "
                     "s.key), s.seq LIMIT ?",
                 {ranked_at_once}));
}

/// Forgets the result of a stage with its done bakes; returns its blobs that nothing else needs. A failed or cancelled
/// bake has no result, so its record stays, and with it the stage, as one that has not run.
std::vector<std::string> forget_stage(Sql& sql, const std::string& key) {
    std::vector<std::string> blobs = blobs_of_stage_alone(sql, key);
    forget_done_bakes(sql, key);
    sql.run("DELETE FROM stage_files WHERE stage = ?", {key});
    if (sql.run("UPDATE stages SET state = 'cancelled', manifest = NULL WHERE key = ?1 AND EXISTS(SELECT 1 FROM "
                "bake_stages m WHERE m.stage = ?1)",
                {key}) > 0)
        return blobs;
    sql.run("DELETE FROM stage_inputs WHERE stage = ?", {key});
    sql.run("DELETE FROM stages WHERE key = ?", {key});
    return blobs;
}

/// Blobs that nothing refers to, oldest first: results of stages that were queued again, thumbnails, what a crash left.
std::vector<std::string> oldest_unneeded(Sql& sql) {
    return texts(
        sql.rows("SELECT sha256 FROM blobs bl WHERE NOT EXISTS(SELECT 1 FROM stage_files f WHERE f.sha256 = bl.sha256) "
                 "AND NOT " +
                     is_needed + " ORDER BY used LIMIT ?",
                 {ranked_at_once}));
}

std::vector<std::string> forget_nothing_else(Sql&, const std::string& digest) { return {digest}; }

/// The blobs that one transaction forgot: their files are to be removed.
struct Forgotten {
    std::vector<std::string> blobs;
    std::uint64_t bytes = 0;
};

/// Forgets the oldest of `ranked` by `forget` until `wanted` bytes are free or all are gone.
Forgotten forget_oldest(Sql& sql, BlobStore& store, const std::vector<std::string>& ranked, std::uint64_t wanted,
                        std::vector<std::string> (*forget)(Sql&, const std::string&)) {
    Forgotten forgotten;
    for (std::size_t i = 0; i < ranked.size() && forgotten.bytes < wanted; ++i)
        for (std::string& digest : forget(sql, ranked[i])) {
            store.require_removable(digest);  // else its rows stay, too
            forgotten.bytes += store.size_of(digest).value_or(0);
            forgotten.blobs.push_back(std::move(digest));
        }
    return forgotten;
}

/// Forgets in one transaction. Returns whether `rank` found anything.
bool evict_some(Database& database, BlobStore& store, std::vector<std::string> (*rank)(Sql&),
                std::vector<std::string> (*forget)(Sql&, const std::string&), std::uint64_t wanted) {
    bool some = false;
    Forgotten forgotten;
    database.write([&](Sql& sql) {
        const std::vector<std::string> ranked = rank(sql);
        some = !ranked.empty();
        forgotten = forget_oldest(sql, store, ranked, wanted, forget);
    });
    if (!forgotten.blobs.empty()) store.remove(forgotten.blobs, "the budget is used up; least recently used first");
    return some;
}

}  // namespace

bool is_unneeded(Sql& sql, const std::string& digest) {
    return !sql.rows(
                   "SELECT 1 FROM blobs bl WHERE sha256 = ? AND NOT EXISTS(SELECT 1 FROM stage_files f WHERE f.sha256 "
                   "= bl.sha256) AND NOT " +
                       is_needed,
                   {digest})
                .empty();
}

std::vector<std::string> blobs_of_stage_alone(Sql& sql, const std::string& stage) {
    return texts(sql.rows(
        "SELECT DISTINCT sha256 FROM stage_files f JOIN blobs bl USING(sha256) WHERE f.stage = ? AND NOT EXISTS("
        "SELECT 1 FROM stage_files o WHERE o.sha256 = f.sha256 AND o.stage <> f.stage) AND NOT " +
            is_needed,
        {stage}));
}

std::uint64_t evictable_bytes(Database& database, std::uint64_t enough) {
    std::uint64_t bytes = 0;
    database.read([&](Sql& sql) {
        const SqlRow most =
            sql.rows(
                   "SELECT (SELECT sum(bytes) FROM blobs) - (SELECT coalesce(sum(bytes), 0) FROM sent_blobs JOIN blobs "
                   "USING(sha256))")
                .at(0);
        if (static_cast<std::uint64_t>(most.integer(0)) < enough) {  // a store that is full of inputs
            bytes = static_cast<std::uint64_t>(most.integer(0));
            return;
        }
        std::string last;
        for (bool more = true; more && bytes < enough;) {
            const auto rows = sql.rows("SELECT sha256, bytes FROM blobs bl WHERE sha256 > ? AND NOT " + is_needed +
                                           " AND NOT EXISTS(SELECT 1 FROM stage_files f JOIN stages s ON s.key = "
                                           "f.stage WHERE f.sha256 = bl.sha256 AND (s.state <> 'done' OR " +
                                           live_bake_of_stage + ")) ORDER BY sha256 LIMIT ?",
                                       {last, ranked_at_once});
            for (const SqlRow& row : rows) bytes += static_cast<std::uint64_t>(row.integer(1));
            more = rows.size() == static_cast<std::size_t>(ranked_at_once);
            if (more) last = rows.back().text(0);
        }
    });
    return bytes;
}

void evict(Database& database, BlobStore& store, std::uint64_t budget, std::uint64_t others) {
    const auto held = database.lock();  // rows and files go together
    const std::uint64_t allowed = budget - std::min(budget, others), spare = budget / 100 * 3;
    const std::uint64_t wanted = allowed - std::min(allowed, spare);
    std::uint64_t total = store.total_bytes();
    if (total <= allowed) return;
    store.flush_uses();
    for (; total > allowed; total = store.total_bytes())
        if (!evict_some(database, store, oldest_stages, forget_stage, total - wanted)) break;
    for (; total > allowed; total = store.total_bytes())
        if (!evict_some(database, store, oldest_unneeded, forget_nothing_else, total - allowed)) return;
}

}  // namespace hairbake
