#include "server/jobs/names.h"

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>

#include "core/base/short_text.h"
#include "server/jobs/page.h"
#include "server/jobs/time_text.h"
#include "server/store/blob_store.h"
#include "server/store/database.h"
#include "server/store/refusal.h"

namespace hairbake {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::size_t longest_path = 200, longest_note = 500;
constexpr std::int64_t most_shown = 500;  // versions of a name

void check_name(const std::string& kind, const std::string& path) {
    if (!is_name_kind(kind))
        throw Refusal(Refused::not_found,
                      "there is no kind \"" + kind + "\" of names; allowed is model, environment or mesh", "kind");
    if (!is_name_path(path))
        throw Refusal(Refused::unprocessable,
                      "a name is 1 to 200 characters: letters, digits, '.', '_', '-' in segments separated by '/'",
                      "path");
}

Json version_json(const std::string& kind, const std::string& path, const SqlRow& row, std::size_t first) {
    return {{"kind", kind},
            {"path", path},
            {"version", row.integer(first)},
            {"sha256", row.text(first + 1)},
            {"note", row.text(first + 2)},
            {"token", row.text(first + 3)},
            {"created", time_text(row.number(first + 4))}};
}

Json name_json(Sql& sql, const std::string& kind, const std::string& path) {
    const auto rows = sql.rows(
        "SELECT version, sha256, note, token, created FROM names WHERE kind = ? AND path = ? "
        "ORDER BY version DESC LIMIT ?",
        {kind, path, most_shown});
    if (rows.empty()) throw Refusal(Refused::not_found, "there is no name " + kind + "/" + path);
    Json answer = version_json(kind, path, rows[0], 0);
    answer["versions"] = Json::array();
    for (const SqlRow& row : rows) answer["versions"].push_back(version_json(kind, path, row, 0));
    return answer;
}

}  // namespace

bool is_name_kind(const std::string& kind) { return kind == "model" || kind == "environment" || kind == "mesh"; }

bool is_name_path(const std::string& path) {
    if (path.empty() || path.size() > longest_path) return false;
    std::string segment;
    for (const char c : path + "/") {
        if (c == '/') {
            if (segment.empty() || segment == "." || segment == "..") return false;
            segment.clear();
        } else if (std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '_' || c == '-') {
            segment += c;
        } else {
            return false;
        }
    }
    return true;
}

std::string Names::put(const std::string& kind, const std::string& path, const std::string& sha256,
                       const std::string& note, const std::string& token) {
    check_name(kind, path);
    if (note.size() > longest_note) throw Refusal(Refused::unprocessable, "note is longer than 500 bytes", "note");
    std::string answer;
    database_.write([&](Sql& sql) {
        if (!is_digest(sha256) || sql.rows("SELECT 1 FROM blobs WHERE sha256 = ?", {sha256}).empty())
            throw Refusal(Refused::unprocessable,
                          "sha256 is \"" + shortened(sha256, 64) + "\"; allowed is the digest of a stored blob",
                          "sha256");
        const auto newest =
            sql.rows("SELECT version, sha256 FROM names WHERE kind = ? AND path = ? ORDER BY version DESC LIMIT 1",
                     {kind, path});
        if (newest.empty() || newest[0].text(1) != sha256)
            sql.run(
                "INSERT INTO names(kind, path, version, sha256, note, token, created) VALUES(?, ?, ?, ?, ?, ?, ?)",
                {kind, path, newest.empty() ? std::int64_t(1) : newest[0].integer(0) + 1, sha256, note, token, now()});
        answer = name_json(sql, kind, path).dump();
    });
    return answer;
}

std::string Names::get(const std::string& kind, const std::string& path) {
    check_name(kind, path);
    std::string answer;
    database_.read([&](Sql& sql) { answer = name_json(sql, kind, path).dump(); });
    return answer;
}

std::string Names::list(const std::string& kind, const std::string& cursor, int limit) {
    if (!is_name_kind(kind)) check_name(kind, "x");
    Page page("names", limit);
    database_.read([&](Sql& sql) {
        sql.each(
            "SELECT path, max(version), sha256, note, token, created FROM names WHERE kind = ? AND path > ? GROUP BY "
            "path ORDER BY path LIMIT ?",
            {kind, cursor, std::int64_t(limit) + 1}, [&](const SqlRow& row) {
                if (!page.has_room()) return false;
                page.add(version_json(kind, row.text(0), row, 1).dump(), row.text(0));
                return true;
            });
    });
    return page.take_text();
}

NamedDigest resolve_name(Sql& sql, const std::string& kind, const std::string& name, const std::string& field) {
    const std::size_t at = name.find('@');
    const std::string path = name.substr(0, at), wanted = at == std::string::npos ? "" : name.substr(at + 1);
    const bool number = wanted.size() < 10 &&
                        std::all_of(wanted.begin(), wanted.end(), [](unsigned char c) { return std::isdigit(c); });
    const auto rows =
        !is_name_path(path) || !number ? std::vector<SqlRow>()
        : wanted.empty()
            ? sql.rows("SELECT version, sha256 FROM names WHERE kind = ? AND path = ? ORDER BY version DESC LIMIT 1",
                       {kind, path})
            : sql.rows("SELECT version, sha256 FROM names WHERE kind = ? AND path = ? AND version = ?",
                       {kind, path, std::int64_t(std::stoll(wanted))});
    if (rows.empty())
        throw Refusal(
            Refused::unprocessable,
            field + " asks for name:" + shortened(name, longest_path) + ", which is no name of the kind " + kind, field)
            .at("/" + field);
    return {path, rows[0].text(1), rows[0].integer(0)};
}

}  // namespace hairbake
