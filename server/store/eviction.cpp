#include "server/store/eviction.h"

#include <optional>
#include <vector>

namespace hairbake {
namespace {

constexpr const char* live_bake_of_stage =
    "EXISTS(SELECT 1 FROM bakes b WHERE b.transmittance = s.key AND b.state IN ('queued', 'running')) OR "
    "EXISTS(SELECT 1 FROM bakes b WHERE b.irradiance = s.key AND b.state IN ('queued', 'running'))";

constexpr int stages_at_once = 100;

/// The stored stages that were used longest ago and that no live bake needs, oldest first.
std::vector<std::string> oldest_stages(Sql& sql) {
    std::vector<std::string> keys;
    for (const SqlRow& row :
         sql.rows(std::string("SELECT s.key FROM stages s WHERE s.state = 'done' AND NOT (") + live_bake_of_stage +
                      ") ORDER BY (SELECT max(bl.used) FROM stage_files f JOIN blobs bl USING(sha256) "
                      "WHERE f.stage = s.key), s.seq LIMIT ?",
                  {std::int64_t(stages_at_once)}))
        keys.push_back(row.text(0));
    return keys;
}

/// Forgets a stage and the bakes that it finished; returns its blobs that nothing else refers to.
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
    sql.run("DELETE FROM batch_bakes WHERE bake IN (SELECT id FROM bakes WHERE transmittance = ? OR irradiance = ?)",
            {key, key});
    sql.run("DELETE FROM bake_names WHERE bake IN (SELECT id FROM bakes WHERE transmittance = ? OR irradiance = ?)",
            {key, key});
    sql.run("DELETE FROM bakes WHERE transmittance = ?", {key});
    sql.run("DELETE FROM bakes WHERE irradiance = ?", {key});
    sql.run("DELETE FROM stage_files WHERE stage = ?", {key});
    sql.run("DELETE FROM stage_inputs WHERE stage = ?", {key});
    sql.run("DELETE FROM stages WHERE key = ?", {key});
    return blobs;
}

/// The input that was used longest ago and that nothing live refers to; empty when there is none.
std::string oldest_input(Sql& sql, const std::string& spared) {
    const auto rows = sql.rows(
        std::string(
            "SELECT sha256 FROM blobs bl WHERE sha256 <> ? AND "
            "NOT EXISTS(SELECT 1 FROM stage_files f WHERE f.sha256 = bl.sha256) AND "
            "NOT EXISTS(SELECT 1 FROM inputs i WHERE i.thumbnail = bl.sha256) AND "
            "NOT EXISTS(SELECT 1 FROM names n WHERE n.sha256 = bl.sha256 AND n.version = (SELECT max(version) "
            "FROM names m WHERE m.kind = n.kind AND m.path = n.path)) AND "
            "NOT EXISTS(SELECT 1 FROM stage_inputs t JOIN stages s ON s.key = t.stage WHERE t.sha256 = bl.sha256 "
            "AND (") +
            live_bake_of_stage + ")) ORDER BY used LIMIT 1",
        {spared});
    return rows.empty() ? std::string() : rows[0].text(0);
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

/// Forgets what is oldest until `excess` bytes are free or a transaction has done enough. Returns the blobs to remove;
/// nothing when there is nothing to forget.
std::optional<std::vector<std::string>> forget_oldest(Sql& sql, BlobStore& store, std::uint64_t excess,
                                                      const std::string& spared) {
    std::vector<std::string> blobs;
    std::uint64_t freed = 0;
    const auto take = [&](const std::vector<std::string>& forgotten) {
        for (const std::string& digest : forgotten) freed += store.size_of(digest).value_or(0);
        blobs.insert(blobs.end(), forgotten.begin(), forgotten.end());
    };
    const std::vector<std::string> stages = oldest_stages(sql);
    for (std::size_t i = 0; i < stages.size() && freed < excess; ++i) take(forget_stage(sql, stages[i]));
    if (!stages.empty()) return blobs;
    const std::string input = oldest_input(sql, spared);
    if (input.empty()) return std::nullopt;
    take(forget_input(sql, input));
    return blobs;
}

}  // namespace

bool evict(Database& database, BlobStore& store, std::uint64_t budget, const std::string& spared) {
    const auto held = database.lock();  // rows and files go together
    std::uint64_t total = store.total_bytes();
    if (total <= budget) return true;
    store.flush_uses();
    for (; total > budget; total = store.total_bytes()) {
        std::optional<std::vector<std::string>> blobs;
        database.write([&](Sql& sql) { blobs = forget_oldest(sql, store, total - budget, spared); });
        if (!blobs) return false;
        store.remove(*blobs);
    }
    return true;
}

}  // namespace hairbake
