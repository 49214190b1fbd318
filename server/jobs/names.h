// Names for digests, because artists do not think in digests. Every earlier version stays.
#pragma once

#include <optional>
#include <string>

#include "server/store/database.h"

namespace hairbake {

/// "model", "environment" and "mesh".
bool is_name_kind(const std::string& kind);

/// 1 to 200 characters: segments of letters, digits, '.', '_' and '-', separated by '/'; no segment is "." or "..".
bool is_name_path(const std::string& path);

struct NamedDigest {
    std::string path, sha256;
    std::int64_t version = 0;
};

/// All functions take part in the caller's transaction. Answers are JSON objects.
class Names {
public:
    /// Points the name at a stored blob; the same digest again makes no new version. Throws Refusal.
    static std::string put(Sql& sql, const std::string& kind, const std::string& path, const std::string& sha256,
                           const std::string& note, const std::string& token);
    /// The newest version, or version n of "path@n". Throws Refusal(unprocessable) naming `field`.
    static NamedDigest resolve(Sql& sql, const std::string& kind, const std::string& name, const std::string& field);
    /// All versions, newest first. Throws Refusal(not_found).
    static std::string get(Sql& sql, const std::string& kind, const std::string& path);
    /// {"names": [...], "next": cursor or null}: newest versions of a kind by path, after `cursor`.
    static std::string list(Sql& sql, const std::string& kind, const std::string& cursor, int limit);
};

}  // namespace hairbake
