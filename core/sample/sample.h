// Sample data: a groom on a head and three skies, from a seed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"

namespace hairbake {

struct SampleSettings {
    std::string style = "straight";      ///< straight, wavy or curly
    std::uint64_t vertices = 1'500'000;  ///< of the groom
    std::optional<int> paper_model;      ///< 1 to 4: style and vertex count of a published model, instead
    int map_width = 1024;                ///< of the lat-long maps; even, 16 to 4096
    std::uint64_t seed = 1;
};

/// Writes groom.hair, head.obj, sky.hdr, studio.hdr and overcast.hdr to `folder` (made when missing), replacing files
/// of these names; the same settings give the same bytes. Returns the paths. Throws Error(usage) naming the field out
/// of range, Error(out_of_resources), Error(cancelled) between files.
std::vector<std::filesystem::path> write_samples(const std::filesystem::path& folder, const SampleSettings& settings,
                                                 Progress& progress);

/// Removes what write_samples leaves in `folder` when it is stopped in the middle of a file; it does so itself when it
/// throws. For a process that ends while it runs: after a cancel nothing is begun that this would miss.
void discard_sample_parts(const std::filesystem::path& folder) noexcept;

}  // namespace hairbake
