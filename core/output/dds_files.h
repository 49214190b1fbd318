// Irradiance maps as DDS cube maps with all mip levels, for Unreal and Godot.
#pragma once

#include <filesystem>
#include <vector>

#include "core/base/progress.h"
#include "core/output/file_sink.h"
#include "core/result/map_set.h"

namespace hairbake {

/// diffuse.dds and specular_00.dds ... : one cube map a file, as Unreal and Godot read no arrays of them. DX10 header,
/// DXGI_FORMAT_R16G16B16A16_FLOAT, linear, alpha 1; faces +X -X +Y -Y +Z -Z, rows from the top, each face followed by
/// its mip levels down to 1x1 (cube_mips.h; made of floats, then rounded). Set the texture to level 0 for look-ups by
/// tangent; at other levels the card blurs between neighbouring strands.
///
/// The format has no place for text: the manifest alone has exponent, theta' and scale (half.h: the value is the stored
/// half times the scale).
/// Throws Error(bad_input) for maps that are not finite.
/// Throws Error(cancelled) between files, and what FileSink throws.
std::vector<WrittenFile> write_map_dds(const MapSet& maps, const std::filesystem::path& folder, Progress& progress);

}  // namespace hairbake
