#include "core/output/dds_files.h"

#include <cstdint>
#include <span>

#include "core/output/cube_mips.h"
#include "core/output/format_table.h"
#include "core/output/half.h"
#include "core/output/little_endian.h"
#include "core/output/map_metadata.h"

namespace hairbake {
namespace {

/// DDS_HEADER and DDS_HEADER_DXT10 of a cube map with `levels` levels, 148 bytes with the magic word.
std::string dds_header(int face_size, int levels) {
    const auto n = static_cast<std::uint32_t>(face_size);
    std::string bytes;
    const auto word = [&](std::uint32_t value) { append_integers(bytes, value); };
    const auto zeros = [&](std::size_t count) { bytes.append(4 * count, '\0'); };
    bytes += "DDS ";
    word(124);
    word(0x2100F);  // caps, height, width, pitch, pixel format, mip count
    word(n);
    word(n);
    word(static_cast<std::uint32_t>(n * sizeof(Half4)));
    word(0);
    word(static_cast<std::uint32_t>(levels));
    zeros(11);
    word(32);
    word(4);  // a four-character code follows
    bytes += "DX10";
    zeros(5);
    word(0x401008);  // complex, texture, mip map
    word(0xFE00);    // cube map with all six faces
    zeros(3);
    word(10);  // DXGI_FORMAT_R16G16B16A16_FLOAT
    word(3);   // two-dimensional
    word(4);   // cube map
    word(1);   // array of one
    word(0);
    return bytes;
}

WrittenFile write_cube(const CubeTexels& map, int face_size, double scale, const std::filesystem::path& file,
                       const std::string& content) {
    const std::vector<CubeTexels> levels = cube_mips(map, face_size);
    std::vector<std::vector<Half4>> halves;
    halves.reserve(levels.size());
    for (const CubeTexels& level : levels) halves.push_back(to_half_texels(level, scale));
    FileSink sink(file);
    sink.write(dds_header(face_size, static_cast<int>(levels.size())));
    for (std::size_t face = 0; face < cube_faces; ++face)
        for (const std::vector<Half4>& level : halves) {
            const std::size_t count = level.size() / cube_faces;
            sink.write(std::as_bytes(std::span(level).subspan(face * count, count)));
        }
    WrittenFile written = sink.finish();
    const auto n = static_cast<std::size_t>(face_size);
    written.shape = {6, n, n, 4};
    written.content = content;
    written.scale = scale;
    return written;
}

}  // namespace

std::vector<WrittenFile> write_map_dds(const MapSet& maps, const std::filesystem::path& folder, Progress& progress) {
    const double scale = half_scale(maps);
    std::vector<WrittenFile> files;
    for (const MapLobe& lobe : maps.lobes)
        for (std::size_t i = 0; i < lobe.cubes.size(); ++i) {
            progress.check();
            const std::string slice =
                lobe.has_slices() ? "theta' " + number_text(lobe.theta_prime_deg[i / lobe.orders]) + " degrees, " : "";
            files.push_back(write_cube(lobe.cubes[i], maps.face_size, scale, folder / (lobe.file_name(i) + ".dds"),
                                       lobe.name + " map: " + slice + "cube map with mip levels, half floats, RGBA"));
        }
    return files;
}

std::vector<WrittenFile> write_dds(const OutputContext& context, const StagePart& part) {
    if (!part.maps) return {};
    return write_map_dds(*part.maps, context.folder, context.progress);
}

}  // namespace hairbake
