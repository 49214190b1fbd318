// Names that stand for digests. A name keeps all its versions.
#pragma once

#include <cstdint>
#include <string>

namespace hairbake {

class Database;
class Sql;

/// "model", "environment" and "mesh".
bool is_name_kind(const std::string& kind);

/// 1 to 200 characters: segments of letters, digits, '.', '_' and '-', separated by '/'; no segment is "." or "..".
bool is_name_path(const std::string& path);

struct NamedDigest {
    std::string path, sha256;
    std::int64_t version = 0;
};

/// Thread-safe. Answers are JSON objects.
class Names {
public:
    explicit Names(Database& database) : database_(database) {}

    /// Points the name at a stored blob. The digest that it has already makes no new version.
    /// `token` names the caller.
    /// Throws Refusal.
    std::string put(const std::string& kind, const std::string& path, const std::string& sha256,
                    const std::string& note, const std::string& token);

    /// All versions, newest first.
    /// Throws Refusal(not_found).
    std::string get(const std::string& kind, const std::string& path);

    /// {"names": [...], "next": cursor or null}: the newest versions of a kind's names, sorted by path, after `cursor`.
    std::string list(const std::string& kind, const std::string& cursor, int limit);

private:
    Database& database_;
};

/// The newest version of the name "path", or version n of "path@n", in the caller's transaction.
/// Throws Refusal(unprocessable) naming `field`.
NamedDigest resolve_name(Sql& sql, const std::string& kind, const std::string& name, const std::string& field);

}  // namespace hairbake
