// Room for a result that other bakes which have not ended hold: later ones give way.
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "server/jobs/queue.h"
#include "server/store/blob_store.h"
#include "server/store/database.h"
#include "server/store/eviction.h"
#include "server/store/pruning.h"

namespace hairbake {
namespace {

constexpr const char* first_bake =  // that has not ended, of a stage: 0 priority, 1 seq
    "SELECT b.priority, b.seq FROM bake_stages m JOIN bakes b ON b.seq = m.bake WHERE m.stage = ? AND b.state IN "
    "('queued', 'running') ORDER BY b.priority DESC, b.seq LIMIT 1";
/// Stored stages that bakes need which have not ended, and all of these are later than one of priority ?1 and age ?2;
/// those of the latest bakes first.
constexpr const char* later_results =
    "SELECT s.key FROM stages s JOIN bake_stages m ON m.stage = s.key JOIN bakes b ON b.seq = m.bake WHERE s.state = "
    "'done' AND b.state IN ('queued', 'running') GROUP BY s.key HAVING max(b.priority > ?1 OR (b.priority = ?1 AND "
    "b.seq <= ?2)) = 0 ORDER BY max(b.priority), min(b.seq) DESC";

/// A result that gives way.
struct Giving {
    std::string stage;
    std::vector<std::string> blobs;
};

/// The first of the later results that hold `bytes`; empty where they hold less.
std::vector<Giving> giving_way(Sql& sql, const std::string& stage, std::uint64_t bytes) {
    const auto own = sql.rows(first_bake, {stage});
    if (own.empty()) return {};
    std::vector<Giving> found;
    std::uint64_t held = 0;
    for (const SqlRow& row : sql.rows(later_results, {own[0].integer(0), own[0].integer(1)})) {
        if (held >= bytes) break;
        Giving giving{row.text(0), blobs_of_stage_alone(sql, row.text(0))};
        for (const std::string& blob : giving.blobs)
            held += static_cast<std::uint64_t>(
                sql.rows("SELECT sum(bytes) FROM blobs WHERE sha256 = ?", {blob}).at(0).integer(0));
        if (!giving.blobs.empty()) found.push_back(std::move(giving));
    }
    return held >= bytes ? found : std::vector<Giving>();
}

}  // namespace

bool Queue::can_give_way(const std::string& stage, std::uint64_t bytes) {
    const auto held = database_.lock();
    bool can = false;
    database_.read([&](Sql& sql) { can = !giving_way(sql, stage, bytes).empty(); });
    return can;
}

bool Queue::make_others_give_way(const std::string& stage, std::uint64_t bytes) {
    const auto held = database_.lock();
    if (!can_give_way(stage, bytes)) return false;
    store_.remove(
        [&](Sql& sql) {
            std::vector<std::string> gone;
            for (const Giving& giving : giving_way(sql, stage, bytes)) {
                forget_done_bakes(sql, giving.stage);
                requeue_stage(sql, giving.stage);
                gone.insert(gone.end(), giving.blobs.begin(), giving.blobs.end());
            }
            return gone;
        },
        "an earlier bake needs the room; the later bakes that wait for these results bake them again");
    return true;
}

}  // namespace hairbake
