#include "server/jobs/sent_blobs.h"

#include <nlohmann/json.hpp>

#include "server/jobs/page.h"
#include "server/jobs/time_text.h"
#include "server/store/database.h"

namespace hairbake {
namespace {

using Json = nlohmann::ordered_json;

// Columns: digest, bytes, created, used, kind.
constexpr const char* sent =
    "SELECT bl.sha256, bl.bytes, bl.created, bl.used, (SELECT i.kind FROM inputs i WHERE i.sha256 = bl.sha256 LIMIT 1) "
    "FROM sent_blobs t JOIN blobs bl USING(sha256) WHERE bl.sha256 > ? ";
constexpr const char* without_references =
    "AND NOT EXISTS(SELECT 1 FROM inputs i WHERE i.sha256 = bl.sha256) "
    "AND NOT EXISTS(SELECT 1 FROM inputs i WHERE i.thumbnail = bl.sha256) "
    "AND NOT EXISTS(SELECT 1 FROM names n WHERE n.sha256 = bl.sha256) "
    "AND NOT EXISTS(SELECT 1 FROM stage_inputs i JOIN bake_stages m ON m.stage = i.stage "
    "JOIN bakes b ON b.seq = m.bake WHERE i.sha256 = bl.sha256 AND b.state IN ('queued', 'running', 'done')) ";

Json entry(const SqlRow& row) {
    return {{"sha256", row.text(0)},
            {"bytes", row.integer(1)},
            {"created", time_text(row.number(2))},
            {"used", time_text(row.number(3))},
            {"kind", row.null(4) ? Json() : Json(row.text(4))},
            {"links", {{"self", "/v1/blobs/" + row.text(0)}}}};
}

}  // namespace

std::string list_sent_blobs(Database& database, const std::string& cursor, int limit, bool unneeded) {
    Page page("blobs", limit);
    database.read([&](Sql& sql) {
        sql.each(std::string(sent) + (unneeded ? without_references : "") + "ORDER BY bl.sha256 LIMIT ?",
                 {cursor, std::int64_t(limit) + 1}, [&](const SqlRow& row) {
                     if (!page.has_room()) return false;
                     page.add(entry(row).dump(), row.text(0));
                     return true;
                 });
    });
    return page.take_text();
}

}  // namespace hairbake
