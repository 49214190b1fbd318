// Irradiance maps for browsers: half floats as WebGL takes them, and a JSON file.
#pragma once

#include <filesystem>
#include <vector>

#include "core/base/progress.h"
#include "core/output/file_sink.h"
#include "core/result/map_set.h"

namespace hairbake {

/// maps.f16: little-endian half floats [1 + (M + 1), 6, n, n, 4]: the diffuse map, then the specular maps by theta';
/// face (+X -X +Y -Y +Z -Z), row from the top, column, RGBA with alpha 1. A face is n * n * 8 bytes, a map six of them:
///     gl.texImage2D(gl.TEXTURE_CUBE_MAP_POSITIVE_X + face, 0, gl.RGBA16F, n, n, 0, gl.RGBA, gl.HALF_FLOAT,
///                   new Uint16Array(buffer, map.offset + face * n * n * 8, n * n * 4))
/// with UNPACK_FLIP_Y_WEBGL off. (three.js negates x in its own cube look-ups.)
///
/// maps.json: one object of
///     content "hairbake irradiance maps"; file "maps.f16"; type "float16"; byte_order "little"; shape, as above;
///     face_size n; channels "RGBA"; faces ["+X", "-X", ...]; rows "from the top";
///     scale: the value is the stored half times this power of two (half.h);
///     model, exponent, units, frame, primaries: texts, except the exponent;
///     maps: a list of {name "diffuse" or "specular", theta_prime_deg (specular only), offset, bytes}, in bytes of
///     maps.f16.
///
/// Throws Error(bad_input) for maps that are not finite, Error(cancelled) between maps, and what FileSink throws.
std::vector<WrittenFile> write_map_raw(const MapSet& maps, const std::string& primaries,
                                       const std::filesystem::path& folder, Progress& progress);

}  // namespace hairbake
