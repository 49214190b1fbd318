#include "server/store/pruning.h"

#include "server/store/database.h"

namespace hairbake {

void prune(Database& database, double time) {
    database.write([&](Sql& sql) {
        sql.run(
            "DELETE FROM batches WHERE created < ? AND NOT EXISTS(SELECT 1 FROM batch_bakes m JOIN bakes b "
            "ON b.id = m.bake WHERE m.batch = batches.id AND b.state IN ('queued', 'running'))",
            {time});
        const std::string ended = "FROM bakes WHERE state IN ('failed', 'cancelled') AND finished < ?";
        sql.run("DELETE FROM bake_stages WHERE bake IN (SELECT seq " + ended + ")", {time});
        sql.run("DELETE " + ended, {time});
        sql.run(
            "DELETE FROM batch_bakes WHERE batch NOT IN (SELECT id FROM batches) OR bake NOT IN (SELECT id FROM "
            "bakes)");
        sql.run("DELETE FROM bake_names WHERE bake NOT IN (SELECT id FROM bakes)");
        sql.run(
            "DELETE FROM stages WHERE state IN ('failed', 'cancelled') AND "
            "NOT EXISTS(SELECT 1 FROM bake_stages m WHERE m.stage = stages.key)");
        sql.run("DELETE FROM stage_inputs WHERE stage NOT IN (SELECT key FROM stages)");
    });
}

}  // namespace hairbake
