// AMD's TressFX asset (.tfx), binary versions 3.0 and 4.0: the guide strands of a game's hair.
//
// Layout (little-endian; uint32 but the first; offsets in bytes from the file's beginning, 0 for an array that is not
// there; strand after strand, root first, every strand with the same number of points):
//   4.0: float version; strands; points a strand; offsets of positions (float4: x, y, z, inverse mass), strand UV
//        (float2), vertex UV (float2), strand thickness (float), vertex colours (float4); 32 reserved: 160 bytes.
//   3.0: float version; strands; points a strand; follow hairs a guide; both ends immovable; 31 reserved; offsets of
//        positions (float3), strand thickness, strand UV, vertex colours (float4), guide flags, vertex UV; 32 reserved:
//        296 bytes.
// Source: AMD's published header TressFXFileFormat.h of TressFX 3 and 4, and files of either version.
//
// What is read: positions, and the vertex colours' RGB. What is not:
// - inverse masses, UVs, guide flags, the colours' fourth component: a HairModel has no place for them;
// - the thickness array: no published exporter writes it, AMD's loaders do not read it, and its unit is stated nowhere.
//   A TressFX file therefore never has a width, and a bake needs strand.width;
// - follow hairs: the engine grows them at run time at random around the guides that the file holds, so that they are
//   nobody's vertices. The model's free text names their number.
#pragma once

#include <cstddef>
#include <span>

namespace hairbake {

/// Whether a file that begins with `bytes` (four are enough) says that it is a TressFX file of a version read here.
bool begins_as_tfx(std::span<const std::byte> bytes);

}  // namespace hairbake
