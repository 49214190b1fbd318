// TressFX files put together byte by byte.
#pragma once

#include <cstdint>

#include "tests/support/hair_bytes.h"

namespace hairbake::test_support {

/// Offsets of the fields of a TressFX header, in bytes.
struct TfxOffsets {
    std::size_t header, positions, strand_uv, vertex_uv, thickness, colors;
};
inline constexpr TfxOffsets kTfx4{160, 12, 16, 20, 24, 28};
inline constexpr TfxOffsets kTfx3{296, 144, 152, 164, 148, 156};

/// A file of version 3 or 4 with `strands` strands of `points` points and every array that the header can name, in the
/// order thickness (0.5 a strand), strand UV, positions, vertex colours: no reader may count on the order.
/// Point i lies at (i, 0.5 i, -i) with the inverse mass NaN (version 4) and is coloured (0.1, 0.2, 0.001 i, NaN): what
/// is not read may be anything. In version 3 each guide has 7 follow hairs.
inline HairBytes make_tfx_bytes(int version, std::uint32_t strands, std::uint32_t points) {
    const float nan = __builtin_nanf("");
    const TfxOffsets& at = version == 4 ? kTfx4 : kTfx3;
    HairBytes file;
    file.bytes.resize(at.header);
    file.set(0, static_cast<float>(version)).set(4, strands).set(8, points);
    if (version == 3) file.set(12, std::uint32_t{7});
    const auto begin_array = [&](std::size_t field) { file.set(field, static_cast<std::uint32_t>(file.bytes.size())); };
    begin_array(at.thickness);
    for (std::uint32_t s = 0; s < strands; ++s) file.add(0.5f);
    begin_array(at.strand_uv);
    for (std::uint32_t s = 0; s < strands; ++s) file.add(0.25f).add(0.75f);
    begin_array(at.positions);
    for (std::uint32_t i = 0; i < strands * points; ++i) {
        const auto x = static_cast<float>(i);
        file.add(x).add(0.5f * x).add(-x);
        if (version == 4) file.add(nan);
    }
    begin_array(at.colors);
    for (std::uint32_t i = 0; i < strands * points; ++i)
        file.add(0.1f).add(0.2f).add(0.001f * static_cast<float>(i)).add(nan);
    return file;
}

}  // namespace hairbake::test_support
