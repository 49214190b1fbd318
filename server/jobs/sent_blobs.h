// The list of the files that clients sent. They are never evicted, so an operator needs to see them.
#pragma once

#include <string>

namespace hairbake {

class Database;

/// {"blobs": [...], "next": cursor or null}: files that clients sent, sorted by digest, after the digest `cursor`.
///
/// `unneeded`: only those that DELETE /v1/blobs removes without force: no bake but a failed or cancelled one, no name,
/// no model and no environment refers to them.
std::string list_sent_blobs(Database& database, const std::string& cursor, int limit, bool unneeded);

}  // namespace hairbake
