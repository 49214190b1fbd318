// Keeps the store within its budget.
#pragma once

#include <cstdint>
#include <string>

namespace hairbake {

class BlobStore;
class Database;

/// Removes the least recently used blobs when the store's bytes and `incoming` more pass `budget`. Returns whether they
/// fit now.
///
/// Results go first, with their stages and the bakes that they finished, until 3 % of the budget are free or a thousand
/// stages are gone; the next blobs then need no ranking of all stages. Inputs go next, until the budget is kept. A blob
/// that a live bake reads or wrote is never removed, nor is one that a name's newest version refers to.
bool evict(Database& database, BlobStore& store, std::uint64_t budget, std::uint64_t incoming = 0);

/// evict() before a blob of `incoming` bytes. The room is there as long as the caller holds database.lock().
/// Throws Refusal(full) when the blob does not fit.
void make_room(Database& database, BlobStore& store, std::uint64_t budget, std::uint64_t incoming);

}  // namespace hairbake
