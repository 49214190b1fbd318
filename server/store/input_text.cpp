#include "server/store/input_text.h"

#include "server/store/database.h"

namespace hairbake {

std::optional<std::string> input_text(Sql& sql, const std::string& digest) {
    if (sql.rows("SELECT 1 FROM sent_blobs WHERE sha256 = ?", {digest}).empty()) return std::nullopt;
    const auto names = sql.rows(
        "SELECT kind, path, version FROM names WHERE sha256 = ? ORDER BY created DESC, version DESC LIMIT 1", {digest});
    if (!names.empty())
        return "the " + names[0].text(0) + " " + names[0].text(1) + "@" + std::to_string(names[0].integer(2)) +
               " (sha256:" + digest + ")";
    const auto kinds = sql.rows("SELECT kind FROM inputs WHERE sha256 = ? LIMIT 1", {digest});
    return "the " + (kinds.empty() ? "file" : kinds[0].text(0)) + " sha256:" + digest;
}

}  // namespace hairbake
