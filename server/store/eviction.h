// Keeps the store within its budget.
#pragma once

#include <cstdint>
#include <string>

#include "server/store/blob_store.h"
#include "server/store/database.h"

namespace hairbake {

/// Removes what was used longest ago until the blobs take at most `budget` bytes: results first (their stages and
/// finished bakes are forgotten), then inputs. Never what a live bake reads or wrote or a name's newest version points
/// at, nor `spared` (a blob on its way into a request). Returns whether the store is within the budget.
bool evict(Database& database, BlobStore& store, std::uint64_t budget, const std::string& spared = {});

}  // namespace hairbake
