// Forgets what nobody will ask for any more.
#pragma once

#include "server/store/database.h"

namespace hairbake {

/// Failed and cancelled bakes that ended before `time` (seconds since 1970), stages of those states that no bake refers
/// to, and batches made before it whose bakes have all ended. Done bakes go with their results (eviction.h); versions
/// of names stay.
void prune(Database& database, double time);

}  // namespace hairbake
