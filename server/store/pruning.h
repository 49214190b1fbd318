// Forgets old records of work that ended without a result.
#pragma once

#include <string>
#include <vector>

#include "server/store/database.h"

namespace hairbake {

/// Removes failed and cancelled bakes that ended before `time` (seconds since 1970), failed and cancelled stages that
/// no bake has, and batches made before `time` whose bakes have all ended. Done bakes stay until their results are
/// evicted (eviction.h); versions of names stay. Notes of forgotten bakes stay as long again, 100,000 of them at most.
void prune(Database& database, double time);

/// Removes the rows of bakes (columns seq, id, state) and notes their ids: a client that asks for one learns that there
/// was one. Their stages stay.
void forget_bakes(Sql& sql, const std::vector<SqlRow>& bakes);

/// The same for the done bakes of a stage whose result goes. Failed and cancelled ones have no result: their records
/// stay for their time.
void forget_done_bakes(Sql& sql, const std::string& stage);

}  // namespace hairbake
