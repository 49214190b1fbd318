// Stages that another version of hairbake has queued. The key of a stage tells its algorithm version, so the workers of
// this version cannot make them. They are planned again from their requests.
#include "server/jobs/queue.h"
#include "server/store/blob_store.h"
#include "server/store/database.h"

namespace hairbake {

/// Whether the queued stage is of another version. Then its live bakes get the stage of this version in its place and
/// keep their ids. The row stays, cancelled, until store/pruning.cpp finds that no bake refers to it.
bool Queue::plan_again(Sql& sql, const std::string& stage) {
    const SqlRow row = sql.rows("SELECT kind, request, priority FROM stages WHERE key = ?", {stage}).at(0);
    const std::optional<StagePlan> plan = plan_stage_again(row.text(0), row.text(1));
    if (!plan || plan->key == stage) return false;
    add_stage(sql, *plan, static_cast<int>(row.integer(2)));
    const std::vector<std::string> bakes = live_bakes_of(sql, stage);
    sql.run(
        "UPDATE bake_stages SET stage = ? WHERE stage = ? AND bake IN (SELECT b.seq FROM bake_stages m JOIN bakes b ON "
        "b.seq = m.bake WHERE m.stage = ? AND b.state IN ('queued', 'running'))",
        {plan->key, stage, stage});
    sql.run("UPDATE stages SET state = 'cancelled', finished = ? WHERE key = ?", {now(), stage});
    for (const std::string& bake : bakes) settle_bake(sql, bake);
    return true;
}

std::size_t Queue::plan_queued_again(Sql& sql) {
    std::size_t planned = 0;
    for (const SqlRow& row : sql.rows("SELECT key FROM stages WHERE state = 'queued' ORDER BY seq"))
        planned += plan_again(sql, row.text(0));
    return planned;
}

}  // namespace hairbake
