// Forgets old records of work that ended without a result.
#pragma once

namespace hairbake {

class Database;

/// Removes failed and cancelled bakes that ended before `time` (seconds since 1970), failed and cancelled stages that
/// no bake has, and batches made before `time` whose bakes have all ended. Done bakes stay until their results are
/// evicted (eviction.h); versions of names stay.
void prune(Database& database, double time);

}  // namespace hairbake
