// AMD's TressFX asset (.tfx), binary versions 3.0 and 4.0: the guide strands of a game's hair.
//
// Layout (little-endian; uint32 except the first; offsets in bytes from the file's beginning, 0 for an array that is
// not there; strand after strand, root first, every strand with the same number of points):
//   4.0: float version; strands; points a strand; offsets of positions (float4: x, y, z, inverse mass), strand UV
//        (float2), vertex UV (float2), strand thickness (float), vertex colours (float4); 32 reserved: 160 bytes.
//   3.0: float version; strands; points a strand; follow hairs a guide; both ends immovable; 31 reserved; offsets of
//        positions (float3), strand thickness, strand UV, vertex colours (float4), guide flags, vertex UV; 32 reserved:
//        296 bytes.
// Source: AMD's published header TressFXFileFormat.h of TressFX 3 and 4, and files of either version.
//
// Read are positions, and the RGB of the vertex colours. Left out are:
// - inverse masses, UVs, guide flags and the fourth component of the colours: a HairModel has no place for them;
// - the thickness array: no published exporter writes it, AMD's loaders do not read it, and its unit is stated nowhere.
//   So a TressFX file never gives a width, and a bake needs strand.width;
// - follow hairs: the engine generates them at run time, at random around the guides in the file. They are no vertices
//   of the file. The groom's description states their number.
#pragma once

#include "core/hair/hair_reader.h"

namespace hairbake {

/// Recognises a file by its version number, 3.0 or 4.0.
extern const HairReader tfx_reader;

}  // namespace hairbake
