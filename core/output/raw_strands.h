// The hair with its transmittance for browsers: arrays that become vertex buffers unchanged, and a JSON file.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "core/hair/hair_model.h"
#include "core/output/file_sink.h"
#include "core/result/vertex_array.h"

namespace hairbake {

/// strands.bin: arrays one after the other, little-endian, each at a multiple of 8 bytes, for V vertices in the file's
/// order and S strands:
///     positions                  float32 [V, 3]        model units (halves would show as steps: they have 11 bits)
///     strand_begin               uint32  [S + 1]       strand s owns the vertices
///                                                      [strand_begin[s], strand_begin[s + 1])
///     tangent_and_transmittance  float16 [V, 4]        unit tangent from root to tip (tangents.h), and A in [0, 1]
///     transmittance_sh           float16 [V, bands^2]  only with sh_bands: coefficients in the order l*l + l + m
///     bent_cone                  float16 [V, 4]        only with bent_cone: unit axis, half-angle in radians
/// 20 bytes a vertex without the last two. The segments to draw follow from strand_begin: vertices i and i + 1 of a
/// strand.
///
/// strands.json: one object of content "hairbake strands"; file "strands.bin"; byte_order "little"; vertices V; strands
/// S; bounds [[x, y, z], [x, y, z]], lowest and highest coordinates (null when V = 0); sh_bands; and arrays, a list of
/// {name, type, shape, offset, bytes} of the arrays that are there.
///
/// Throws what FileSink throws.
std::vector<WrittenFile> write_strand_raw(const HairModel& model, std::span<const VertexArray> arrays,
                                          const std::filesystem::path& folder);

}  // namespace hairbake
