// Sample data: a groom on a head and three skies, from a seed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/base/progress.h"
#include "core/sample/groom_style.h"

namespace hairbake {

struct SampleSettings {
    GroomStyle style = GroomStyle::straight;
    std::uint64_t vertices = 1'500'000;  ///< of the groom
    std::optional<int> paper_model;      ///< 1 to 4: style and vertex count of a published model instead of those above
    int map_width = 1024;                ///< of the lat-long maps; even, 16 to 4096
    std::uint64_t seed = 1;
};

/// Writes groom.hair, head.obj, sky.hdr, studio.hdr and overcast.hdr to `folder`, which it creates when missing. It
/// replaces files of these names. The same settings give the same bytes. Returns the paths.
/// Throws Error(usage) naming the field out of range.
/// Throws Error(bad_input) when the folder cannot be created.
/// Throws Error(out_of_resources) when a file cannot be written whole.
/// Throws Error(cancelled) between files.
std::vector<std::filesystem::path> write_samples(const std::filesystem::path& folder, const SampleSettings& settings,
                                                 Progress& progress);

/// Removes the unfinished file that an interrupted write_samples() leaves in `folder`. write_samples() calls this
/// itself when it throws. A process that is about to end calls it after a cancel; no further file is begun then.
void discard_sample_parts(const std::filesystem::path& folder) noexcept;

}  // namespace hairbake
