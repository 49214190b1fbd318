// Eviction: which blobs may go when the store needs room, and their removal.
//
// Only results go, with their stages and done bakes, and blobs that nothing refers to. A blob that a client sent is
// never evicted: nobody else may have it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace hairbake {

class BlobStore;
class Database;
class Sql;

/// Whether no client sent the blob and nothing refers to it.
bool is_unneeded(Sql& sql, const std::string& digest);

/// Digests of the result's blobs that nothing else needs.
std::vector<std::string> blobs_of_stage_alone(Sql& sql, const std::string& stage);

/// Bytes of the blobs that evict() could remove. Stops to count at `enough`, and then returns at least that. A result
/// below `enough` may be too large.
std::uint64_t evictable_bytes(Database& database, std::uint64_t enough);

/// Removes the least recently used results when the store's bytes and `others` pass `budget`.
///
/// `others` are bytes on the disk that count, too: bodies under way and unfinished uploads.
///
/// It goes on until 3 % of the budget are free or a thousand stages are gone; the next blobs then need no ranking of
/// all stages. Blobs that nothing refers to go next. What a live bake reads or wrote stays, and so does every blob that
/// a client sent, that a name or a stage's input refers to, or that is a model, an environment or a thumbnail.
void evict(Database& database, BlobStore& store, std::uint64_t budget, std::uint64_t others = 0);

}  // namespace hairbake
