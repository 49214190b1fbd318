// HAIR files put together byte by byte, without hairbake's writer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace hairbake::test_support {

/// The format's five array bits.
enum : std::uint32_t { kSegments = 1, kPoints = 2, kThickness = 4, kTransparency = 8, kColors = 16 };

/// A HAIR file in memory. Offsets of the header: 4 strands, 8 points, 12 array bits, 16 default segments,
/// 20 default thickness, 24 default transparency, 28 default colour, 40 free text, 128 the arrays.
struct HairBytes {
    std::vector<std::byte> bytes;

    template <class T>
    HairBytes& add(const T& value) {
        const auto* from = reinterpret_cast<const std::byte*>(&value);
        bytes.insert(bytes.end(), from, from + sizeof value);
        return *this;
    }
    template <class T>
    HairBytes& set(std::size_t offset, const T& value) {
        std::memcpy(bytes.data() + offset, &value, sizeof value);
        return *this;
    }
    operator std::span<const std::byte>() const { return bytes; }
};

/// A file with the given arrays and `segments.size()` strands; without the segments array the caller gives every strand
/// the same number of segments. Point i lies at (i, 0.5 i, -i), is 0.01 + 0.001 i thick, 0.25 transparent and
/// coloured (0.1, 0.2, 0.001 i). The free text is "hello" and then 0x7F up to its end.
inline HairBytes make_hair_bytes(std::uint32_t arrays, const std::vector<std::uint16_t>& segments) {
    std::uint32_t points = 0;
    for (const std::uint16_t count : segments) points += count + 1u;
    HairBytes file;
    file.add('H').add('A').add('I').add('R');
    file.add(static_cast<std::uint32_t>(segments.size())).add(points).add(arrays);
    file.add(std::uint32_t{segments.empty() ? 7u : segments[0]}).add(0.02f).add(0.5f).add(0.9f).add(0.8f).add(0.7f);
    char text[88];
    std::memset(text, 0x7F, sizeof text);
    std::memcpy(text, "hello", 6);
    file.add(text);
    if (arrays & kSegments)
        for (const std::uint16_t count : segments) file.add(count);
    const auto for_each_point = [&](std::uint32_t bit, auto write) {
        for (std::uint32_t i = 0; arrays & bit && i < points; ++i) write(static_cast<float>(i));
    };
    for_each_point(kPoints, [&](float i) { file.add(i).add(0.5f * i).add(-i); });
    for_each_point(kThickness, [&](float i) { file.add(0.01f + 0.001f * i); });
    for_each_point(kTransparency, [&](float) { file.add(0.25f); });
    for_each_point(kColors, [&](float i) { file.add(0.1f).add(0.2f).add(0.001f * i); });
    return file;
}

}  // namespace hairbake::test_support
