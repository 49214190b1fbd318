// Keeps the store within its budget.
#pragma once

#include <cstdint>
#include <string>

#include "server/store/blob_store.h"
#include "server/store/database.h"

namespace hairbake {

/// When the blobs and `incoming` bytes more pass `budget`, removes what was used longest ago: results first (their
/// stages and finished bakes are forgotten) until 3 % of the budget is free or one ranking's have gone, so that the
/// next blobs need no ranking of all that is stored; then inputs, until the budget is kept. Never what a live bake
/// reads or wrote or a name's newest version points at. Returns whether the budget is kept.
bool evict(Database& database, BlobStore& store, std::uint64_t budget, std::uint64_t incoming = 0);

/// evict() for who brings a blob of `incoming` bytes; throws Refusal(full) when it cannot be taken. The room is there
/// as long as the caller holds database.lock().
void make_room(Database& database, BlobStore& store, std::uint64_t budget, std::uint64_t incoming);

}  // namespace hairbake
