// The hair as lines with its transmittance: a binary glTF 2.0 file, written by tinygltf.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "core/hair/hair_model.h"
#include "core/output/file_sink.h"
#include "core/result/vertex_array.h"

namespace hairbake {

/// hair.glb: one scene, node, mesh and primitive with the attributes
///     POSITION        float32 VEC3   the model's own unit and vertex order; glTF means metres, nothing is scaled
///     _TANGENT        float32 VEC3   unit, root to tip (tangents.h); glTF's TANGENT is a VEC4 of surfaces
///     _TRANSMITTANCE  float32 SCALAR A in [0, 1]
///     _TRANSMITTANCE_SH_0 ... _TRANSMITTANCE_SH_15  float32 SCALAR, bands^2 of them, with sh_bands: l*l + l + m
///     _BENT_CONE      float32 VEC4   unit axis and half-angle in radians, with bent_cone
/// The primitive is of mode LINES (1) with uint32 indices, two a segment, strand by strand from root to tip. Mode
/// LINE_STRIP would need a primitive for each strand, as glTF forbids to restart a strip, and viewers make an object
/// and a draw call of each of 50,000 primitives. A new strand begins where the first index of a pair differs from the
/// last index of the pair before. A model without any segment is of mode POINTS without indices. A model without
/// vertices is a file with an empty scene. The mesh's extras hold strands, units and frame; asset.generator names
/// hairbake.
///
/// Throws what check_glb_size() and FileSink throw.
/// Throws Error(internal) with tinygltf's words.
WrittenFile write_glb(const HairModel& model, std::span<const VertexArray> arrays, const BakeRequest& request,
                      const std::filesystem::path& folder);

/// Throws Error(bad_input) when the file would be larger than the 4 GiB that the format can express: from about 119
/// million vertices on without spherical harmonics and bent cone. Takes no memory, so it can be called before the bake.
void check_glb_size(std::uint64_t vertices, std::uint64_t strands, const BakeRequest& request);

}  // namespace hairbake
