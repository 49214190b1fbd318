// A bake that needs no input of the store. It tells whether this machine can bake at all.
#pragma once

#include <filesystem>

#include "core/base/progress.h"

namespace hairbake {

/// Bakes all stages of a small groom under a small sky, both made here. Reads and writes files as a bake from the store
/// does. The trial needs some MB of memory and a fraction of a second.
/// - folder: an empty folder; it keeps the inputs and the result.
/// Throws Error.
void run_trial(const std::filesystem::path& folder, int threads, BakeProgress& progress);

}  // namespace hairbake
