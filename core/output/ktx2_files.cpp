#include "core/output/ktx2_files.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "core/output/format_table.h"
#include "core/output/half.h"
#include "core/output/little_endian.h"
#include "core/output/map_metadata.h"
#include "core/output/versions.h"

namespace hairbake {
namespace {

// Names and numbers are those of the KTX 2.0 and the Khronos Data Format specifications.
constexpr std::string_view identifier("\xABKTX 20\xBB\r\n\x1A\n", 12);
constexpr std::uint32_t vk_format_r16g16b16a16_sfloat = 97;
constexpr std::uint32_t header_bytes = 80, level_index_bytes = 24, descriptor_bytes = 92;
constexpr std::size_t level_alignment = 8;  // the least common multiple of 4 and of a texel's 8 bytes

std::uint32_t khr_df_primaries(const std::string& name) {
    constexpr std::array<std::pair<std::string_view, std::uint32_t>, 5> known{
        {{"Rec.709", 1}, {"Rec.2020", 4}, {"ACES AP0", 6}, {"ACEScg AP1", 7}, {"Display P3", 10}}};
    for (const auto& [its_name, number] : known)
        if (name == its_name) return number;
    return 0;  // KHR_DF_PRIMARIES_UNSPECIFIED
}

/// The basic data format descriptor: four signed float samples of 16 bits, linear.
std::string data_format_descriptor(const std::string& primaries) {
    std::string bytes;
    const auto word = [&](std::uint32_t value) { append_integers(bytes, value); };
    word(descriptor_bytes);
    word(0);                                               // Khronos, basic format
    word(2 | 88u << 16);                                   // version 1.3; bytes of the block, without the word before
    word(1 | khr_df_primaries(primaries) << 8 | 1 << 16);  // RGBSDA, primaries, linear
    word(0);                                               // texel blocks of 1x1x1
    word(8);                                               // bytes of a block
    word(0);
    for (std::uint32_t i = 0; i < 4; ++i) {
        const std::uint32_t channel = i < 3 ? i : 15;      // red, green, blue, alpha
        word(16 * i | 15 << 16 | (channel | 0xC0) << 24);  // signed float from bit 16 i, 15 + 1 bits
        word(0);
        word(0xBF800000);  // -1 to 1 as floats
        word(0x3F800000);
    }
    return bytes;
}

/// Sorted by key, as the format demands; each entry padded to 4 bytes.
std::string key_value_data(Metadata entries) {
    std::sort(entries.begin(), entries.end());
    std::string bytes;
    for (const auto& [key, value] : entries) {
        append_integers(bytes, static_cast<std::uint32_t>(key.size() + value.size() + 2));
        bytes.append(key).append(1, '\0').append(value).append(1, '\0');
        pad(bytes, 4);
    }
    return bytes;
}

/// Everything before the texels. `layers` is 0 for a cube map that is no array.
std::string file_start(int face_size, std::uint32_t layers, const std::string& primaries, const Metadata& metadata) {
    const std::string descriptor = data_format_descriptor(primaries), key_values = key_value_data(metadata);
    const auto size = static_cast<std::uint32_t>(face_size);
    const std::uint32_t descriptor_offset = header_bytes + level_index_bytes;
    const std::uint32_t key_value_offset = descriptor_offset + descriptor_bytes;
    const auto key_value_bytes = static_cast<std::uint32_t>(key_values.size());
    const std::uint64_t end = key_value_offset + key_value_bytes;
    const std::uint64_t level_offset = (end + level_alignment - 1) / level_alignment * level_alignment;
    const std::uint64_t level_bytes = std::uint64_t(std::max(layers, 1u)) * cube_faces * size * size * sizeof(Half4);

    std::string bytes(identifier);
    append_integers(bytes, vk_format_r16g16b16a16_sfloat, std::uint32_t(2), size, size, std::uint32_t(0), layers,
                    std::uint32_t(cube_faces), std::uint32_t(1), std::uint32_t(0));  // one level, no supercompression
    append_integers(bytes, descriptor_offset, descriptor_bytes, key_value_offset, key_value_bytes);
    append_integers(bytes, std::uint64_t(0), std::uint64_t(0));  // no supercompression data
    append_integers(bytes, level_offset, level_bytes, level_bytes);
    bytes += descriptor;
    bytes += key_values;
    pad(bytes, level_alignment);
    return bytes;
}

Metadata file_metadata(const MapSet& maps, const std::string& map, double scale, const std::string& primaries) {
    Metadata metadata = map_metadata(maps, map);
    metadata.insert(metadata.end(), {{"KTXorientation", "rd"},
                                     {"KTXwriter", "hairbake " + version()},
                                     {"hairbake:faceOrder", "+X -X +Y -Y +Z -Z"},
                                     {"hairbake:primaries", primaries},
                                     {"hairbake:scale", number_text(scale)}});
    return metadata;
}

std::string angles_text(const MapLobe& lobe) {
    std::string angles;
    for (const double angle : lobe.theta_prime_deg) {
        if (!angles.empty()) angles += ' ';
        angles += number_text(angle);
    }
    return angles;
}

WrittenFile finish(FileSink& sink, std::vector<std::size_t> shape, const std::string& content, double scale) {
    WrittenFile written = sink.finish();
    written.shape = std::move(shape);
    written.content = content;
    written.scale = scale;
    return written;
}

}  // namespace

std::vector<WrittenFile> write_map_ktx2(const MapSet& maps, const std::string& primaries,
                                        const std::filesystem::path& folder, Progress& progress) {
    const double scale = half_scale(maps);
    const auto n = static_cast<std::size_t>(maps.face_size);
    std::vector<WrittenFile> files;
    for (const MapLobe& lobe : maps.lobes) {
        Metadata metadata = file_metadata(maps, lobe.name, scale, primaries);
        std::vector<std::size_t> shape{6, n, n, 4};
        std::uint32_t layers = 0;  // of a cube map that is no array
        if (lobe.has_slices()) {
            layers = static_cast<std::uint32_t>(lobe.cubes.size());
            shape.insert(shape.begin(), lobe.cubes.size());
            metadata.emplace_back("hairbake:" + lobe.name + "Maps", std::to_string(layers));
            metadata.emplace_back("hairbake:thetaPrimeDeg", angles_text(lobe));
        }
        FileSink sink(folder / (lobe.name + ".ktx2"));
        sink.write(file_start(maps.face_size, layers, primaries, metadata));
        for (const CubeTexels& cube : lobe.cubes) {
            progress.check();
            sink.write(std::as_bytes(std::span<const Half4>(to_half_texels(cube, scale))));
        }
        files.push_back(finish(sink, shape,
                               lobe.name + (lobe.has_slices() ? " maps: cube map array over theta', half floats, RGBA"
                                                              : " map: cube map of half floats, RGBA"),
                               scale));
    }
    return files;
}

std::vector<WrittenFile> write_ktx2(const OutputContext& context, const StagePart& part) {
    if (!part.maps) return {};
    return write_map_ktx2(*part.maps, context.result.inputs.environment->primaries.name, context.folder, context.progress);
}

}  // namespace hairbake
