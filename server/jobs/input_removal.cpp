#include "server/jobs/input_removal.h"

#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/base/short_text.h"
#include "server/store/blob_store.h"
#include "server/store/database.h"
#include "server/store/eviction.h"
#include "server/store/refusal.h"

namespace hairbake {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::int64_t most_references = 20;

/// What refers to a blob.
struct References {
    std::int64_t live = 0, done = 0, names = 0;
    Json first_bakes = Json::array(), first_names = Json::array();  ///< the newest, live bakes first

    Json json() const {
        return {{"bakes", {{"count", live + done}, {"first", first_bakes}}},
                {"names", {{"count", names}, {"first", first_names}}}};
    }
};

References references_to(Sql& sql, const std::string& digest) {
    const std::string bakes =
        "FROM bakes b WHERE b.state IN ('queued', 'running', 'done') AND b.seq IN (SELECT m.bake FROM stage_inputs i "
        "JOIN bake_stages m ON m.stage = i.stage WHERE i.sha256 = ?) ";
    References found;
    for (const SqlRow& row : sql.rows("SELECT b.state, count(*) " + bakes + "GROUP BY b.state", {digest}))
        (row.text(0) == "done" ? found.done : found.live) += row.integer(1);
    for (const SqlRow& row : sql.rows("SELECT b.id, b.state " + bakes + "ORDER BY b.state = 'done', b.seq DESC LIMIT ?",
                                      {digest, most_references}))
        found.first_bakes.push_back({{"id", row.text(0)}, {"state", row.text(1)}});
    found.names = sql.rows("SELECT count(*) FROM names WHERE sha256 = ?", {digest}).at(0).integer(0);
    for (const SqlRow& row :
         sql.rows("SELECT kind, path, version FROM names WHERE sha256 = ? ORDER BY created DESC, kind, path, version "
                  "DESC LIMIT ?",
                  {digest, most_references}))
        found.first_names.push_back({{"kind", row.text(0)}, {"path", row.text(1)}, {"version", row.integer(2)}});
    return found;
}

/// "1 bake", "2 bakes".
std::string counted(std::int64_t count, const std::string& one, const std::string& many) {
    return std::to_string(count) + " " + (count == 1 ? one : many);
}

/// `what`: "model", "environment" or "file".
void refuse_if_needed(Sql& sql, const std::string& what, const std::string& digest, bool force) {
    const References found = references_to(sql, digest);
    if (found.live > 0)
        throw Refusal(Refused::conflict, counted(found.live, "bake", "bakes") + " that did not end yet, such as " +
                                             found.first_bakes[0]["id"].get<std::string>() + ", needs the " + what +
                                             "; cancel that first")
            .because_of(found.json().dump());
    if (force || found.done + found.names == 0) return;
    std::string parts;
    if (found.done > 0) parts = counted(found.done, "done bake", "done bakes");
    if (found.names > 0)
        parts += (parts.empty() ? "" : " and ") + counted(found.names, "version of a name", "versions of names");
    throw Refusal(Refused::conflict,
                  parts + (found.done + found.names == 1 ? " refers" : " refer") + " to the " + what +
                      ", see needed_by; with force=1 it is deleted all the same: results stay, and a bake that has to "
                      "run again needs the file again",
                  "force")
        .because_of(found.json().dump());
}

bool any(Sql& sql, const std::string& statement, const std::vector<SqlValue>& values) {
    return !sql.rows(statement + " LIMIT 1", values).empty();
}

bool is_result(Sql& sql, const std::string& digest) {
    return any(sql, "SELECT 1 FROM stage_files WHERE sha256 = ?", {digest});
}

/// The kind of input that has the blob as its file, or as its thumbnail; empty when there is none.
std::string kind_of(Sql& sql, const std::string& column, const std::string& digest) {
    const auto rows = sql.rows("SELECT kind FROM inputs WHERE " + column + " = ? LIMIT 1", {digest});
    return rows.empty() ? std::string() : rows[0].text(0);
}

/// "is stored as the kind model; DELETE /v1/models/DIGEST deletes it". Without a kind it is a file that was sent alone,
/// whatever names and bakes use it for.
std::string stored_as(const std::string& kind, const std::string& digest) {
    return (kind.empty() ? "is stored, and as no model or environment" : "is stored as the kind " + kind) +
           "; DELETE /v1/" + (kind.empty() ? "blobs" : kind + "s") + "/" + digest + " deletes it";
}

/// Says where the file is, if it is stored as something else.
[[noreturn]] void refuse_unknown(Sql& sql, const std::string& kind, const std::string& digest) {
    const std::string found = "there is no " + kind + " " + shortened(digest, 64);
    const std::string other = kind_of(sql, "sha256", digest);
    const bool is_sent = any(sql, "SELECT 1 FROM sent_blobs WHERE sha256 = ?", {digest});
    if (other.empty() && !is_sent) throw Refusal(Refused::not_found, found);
    throw Refusal(Refused::not_found, found + "; the file " + stored_as(other, digest), "kind");
}

/// Without its entry of the kind, a model's or environment's blob is needed for something else.
bool is_needed_elsewhere(Sql& sql, const std::string& kind, const std::string& digest) {
    return !kind_of(sql, "sha256", digest).empty() || !kind_of(sql, "thumbnail", digest).empty() ||
           any(sql, "SELECT 1 FROM names WHERE sha256 = ? AND kind <> ?", {digest, kind});
}

/// The client wants it no longer. Bytes that are a result's stay and may be evicted from now on.
void forget_sent(Sql& sql, const std::string& digest, std::vector<std::string>& gone) {
    if (is_result(sql, digest))
        sql.run("DELETE FROM sent_blobs WHERE sha256 = ?", {digest});
    else
        gone.push_back(digest);
}

}  // namespace

void remove_input(BlobStore& store, const std::string& kind, const std::string& digest, bool force) {
    store.remove(
        [&](Sql& sql) {
            std::vector<std::string> gone;
            const auto rows = sql.rows("SELECT thumbnail FROM inputs WHERE kind = ? AND sha256 = ?", {kind, digest});
            if (rows.empty()) refuse_unknown(sql, kind, digest);
            refuse_if_needed(sql, kind, digest, force);
            sql.run("DELETE FROM inputs WHERE kind = ? AND sha256 = ?", {kind, digest});
            if (!is_needed_elsewhere(sql, kind, digest)) forget_sent(sql, digest, gone);
            if (!rows[0].null(0) && is_unneeded(sql, rows[0].text(0))) gone.push_back(rows[0].text(0));
            return gone;
        },
        "the " + kind + " was deleted on request");
}

void remove_blob(BlobStore& store, const std::string& digest, bool force) {
    store.remove(
        [&](Sql& sql) {
            std::vector<std::string> gone;
            if (!any(sql, "SELECT 1 FROM blobs WHERE sha256 = ?", {digest}))
                throw Refusal(Refused::not_found, "there is no blob " + shortened(digest, 64));
            if (const std::string kind = kind_of(sql, "sha256", digest); !kind.empty())
                throw Refusal(Refused::conflict, "the file " + stored_as(kind, digest), "kind");
            if (const std::string kind = kind_of(sql, "thumbnail", digest); !kind.empty())
                throw Refusal(Refused::conflict,
                              "the file is the thumbnail of a stored " + kind + ", and goes with it");
            refuse_if_needed(sql, "file", digest, force);
            if (is_result(sql, digest) && !any(sql, "SELECT 1 FROM sent_blobs WHERE sha256 = ?", {digest}))
                throw Refusal(Refused::conflict, "the file is a result; results are removed when the store needs room");
            forget_sent(sql, digest, gone);
            return gone;
        },
        "the file was deleted on request");
}

}  // namespace hairbake
