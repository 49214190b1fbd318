#include "server/store/eviction.h"

#include <algorithm>
#include <vector>

#include "server/store/blob_store.h"
#include "server/store/database.h"
#include "server/store/refusal.h"

namespace hairbake {
namespace {

constexpr const char* live_bake_of_stage =
    "EXISTS(SELECT 1 FROM bake_stages m CROSS JOIN bakes b ON b.seq = m.bake WHERE m.stage = s.key AND "
    "b.state IN ('queued', 'running'))";

/// Most blobs or stages that one ranking of all gives. The writer's lock is held while they are ranked.
constexpr int ranked_at_once = 1000;

/// The least recently used stored stages that no live bake needs, oldest first.
std::vector<std::string> oldest_stages(Sql& sql) {
    std::vector<std::string> keys;
    for (const SqlRow& row :
         sql.rows(std::string("SELECT s.key FROM stages s WHERE s.state = 'done' AND NOT (") + live_bake_of_stage +
                      ") ORDER BY (SELECT max(bl.used) FROM stage_files f JOIN blobs bl USING(sha256) "
                      "WHERE f.stage = s.key), s.seq LIMIT ?",
                  {std::int64_t(ranked_at_once)}))
        keys.push_back(row.text(0));
    return keys;
}

/// Forgets a stage and its bakes; returns its blobs that nothing else refers to.
std::vector<std::string> forget_stage(Sql& sql, const std::string& key) {
    std::vector<std::string> blobs;
    for (const SqlRow& row :
         sql.rows("SELECT DISTINCT sha256 FROM stage_files f WHERE stage = ? AND NOT EXISTS(SELECT 1 "
                  "FROM stage_files o WHERE o.sha256 = f.sha256 AND o.stage <> f.stage) "
                  "AND sha256 NOT IN (SELECT sha256 FROM stage_inputs) "
                  "AND sha256 NOT IN (SELECT sha256 FROM inputs) "
                  "AND sha256 NOT IN (SELECT sha256 FROM names)",
                  {key}))
        blobs.push_back(row.text(0));
    const std::string ids = "(SELECT b.id FROM bake_stages m JOIN bakes b ON b.seq = m.bake WHERE m.stage = ?)";
    sql.run("DELETE FROM batch_bakes WHERE bake IN " + ids, {key});
    sql.run("DELETE FROM bake_names WHERE bake IN " + ids, {key});
    sql.run("DELETE FROM bakes WHERE seq IN (SELECT bake FROM bake_stages WHERE stage = ?)", {key});
    sql.run("DELETE FROM bake_stages WHERE bake IN (SELECT bake FROM bake_stages WHERE stage = ?)", {key});
    sql.run("DELETE FROM stage_files WHERE stage = ?", {key});
    sql.run("DELETE FROM stage_inputs WHERE stage = ?", {key});
    sql.run("DELETE FROM stages WHERE key = ?", {key});
    return blobs;
}

/// The least recently used inputs that no live bake and no name refers to, oldest first.
std::vector<std::string> oldest_inputs(Sql& sql) {
    std::vector<std::string> digests;
    for (const SqlRow& row :
         sql.rows(std::string("SELECT sha256 FROM blobs bl WHERE "
                              "NOT EXISTS(SELECT 1 FROM stage_files f WHERE f.sha256 = bl.sha256) AND "
                              "NOT EXISTS(SELECT 1 FROM inputs i WHERE i.thumbnail = bl.sha256) AND "
                              "NOT EXISTS(SELECT 1 FROM names n WHERE n.sha256 = bl.sha256 AND n.version = (SELECT "
                              "max(version) FROM names m WHERE m.kind = n.kind AND m.path = n.path)) AND "
                              "NOT EXISTS(SELECT 1 FROM stage_inputs t JOIN stages s ON s.key = t.stage WHERE "
                              "t.sha256 = bl.sha256 AND (") +
                      live_bake_of_stage + ")) ORDER BY used LIMIT ?",
                  {std::int64_t(ranked_at_once)}))
        digests.push_back(row.text(0));
    return digests;
}

std::vector<std::string> forget_input(Sql& sql, const std::string& digest) {
    std::vector<std::string> blobs{digest};
    for (const SqlRow& row :
         sql.rows("SELECT thumbnail FROM inputs i WHERE sha256 = ? AND thumbnail IS NOT NULL AND NOT "
                  "EXISTS(SELECT 1 FROM inputs o WHERE o.thumbnail = i.thumbnail AND o.seq <> i.seq)",
                  {digest}))
        blobs.push_back(row.text(0));
    sql.run("DELETE FROM inputs WHERE sha256 = ?", {digest});
    return blobs;
}

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

bool evict(Database& database, BlobStore& store, std::uint64_t budget, std::uint64_t incoming) {
    if (incoming > budget) return false;  // it cannot fit: evict nothing
    const auto held = database.lock();    // rows and files go together
    const std::uint64_t allowed = budget - incoming, spare = budget / 100 * 3;
    const std::uint64_t wanted = allowed - std::min(allowed, spare);
    std::uint64_t total = store.total_bytes();
    if (total <= allowed) return true;
    store.flush_uses();
    for (; total > allowed; total = store.total_bytes())
        if (!evict_some(database, store, oldest_stages, forget_stage, total - wanted)) break;
    for (; total > allowed; total = store.total_bytes())
        if (!evict_some(database, store, oldest_inputs, forget_input, total - allowed)) return false;
    return true;
}

void make_room(Database& database, BlobStore& store, std::uint64_t budget, std::uint64_t incoming) {
    if (!evict(database, store, budget, incoming))
        throw Refusal(Refused::full, "the store's budget of " + std::to_string(budget) +
                                         " bytes is used up by what live bakes and names need");
}

}  // namespace hairbake
