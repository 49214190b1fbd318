// Irradiance maps as KTX 2.0: RGBA16F cube maps that Vulkan, OpenGL and Direct3D take as they are.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/output/file_sink.h"
#include "core/result/map_set.h"

namespace hairbake {

/// diffuse.ktx2, one cube map, and specular.ktx2, a cube map array whose layer m is theta'_m:
/// VK_FORMAT_R16G16B16A16_SFLOAT, linear, alpha 1, not supercompressed; within a layer the faces +X -X +Y -Y +Z -Z,
/// rows from the top (KTXorientation "rd"). 257 layers of 256x256 take 808 MB and are within the limit of cards (341
/// cubes).
///
/// One level, without mip maps: neighbouring pixels of hair have unrelated tangents, so a card that chose the level by
/// their difference would blur the look-up. (Engines that insist on a mip chain read the .dds files.)
///
/// Key/values beside KTXorientation and KTXwriter, all texts, with "hairbake:" before the name:
/// - map, model, exponent, units, frame, faceOrder;
/// - primaries: `primaries`, as the environment's file named them. The data format descriptor says the same where it
///   knows them;
/// - scale: the value is the stored half times this power of two (half.h);
/// - specularMaps (their count) and thetaPrimeDeg (degrees of each layer, separated by spaces), in specular.ktx2 alone.
///
/// Throws Error(bad_input) for maps that are not finite, Error(cancelled) between layers, and what FileSink throws.
std::vector<WrittenFile> write_map_ktx2(const MapSet& maps, const std::string& primaries,
                                        const std::filesystem::path& folder, Progress& progress);

}  // namespace hairbake
