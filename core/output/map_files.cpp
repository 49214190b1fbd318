#include "core/output/map_files.h"

#include <cstdio>

#include "core/output/format_table.h"
#include "core/output/latlong_picture.h"
#include "core/output/map_metadata.h"
#include "core/output/picture_encoding.h"

namespace hairbake {
namespace {

WrittenFile write_picture(const std::filesystem::path& file, const std::vector<Vec3f>& pixels, int width, int height,
                          const Metadata& metadata, const std::optional<Chromaticities>& primaries,
                          const std::string& content) {
    FileSink sink(file);
    sink.write(encode_exr(pixels, width, height, metadata, primaries));
    WrittenFile written = sink.finish();
    written.shape = {static_cast<std::size_t>(height), static_cast<std::size_t>(width), 3};
    written.content = content;
    return written;
}

void write_one_map(const CubeTexels& cube, int face_size, const std::filesystem::path& folder, const std::string& name,
                   Metadata metadata, const std::optional<Chromaticities>& primaries, std::vector<WrittenFile>& files) {
    Metadata strip = metadata;
    strip.emplace_back("hairbake:layout", "vertical strip of cube faces, OpenGL orientation, rows from the top");
    strip.emplace_back("hairbake:faceOrder", "+X -X +Y -Y +Z -Z");
    files.push_back(write_picture(folder / (name + ".exr"), cube, face_size, 6 * face_size, strip, primaries,
                                  "cube faces in a vertical strip"));

    const Picture picture = to_latlong(cube, face_size, 4 * face_size);
    metadata.emplace_back("hairbake:layout", "lat-long, row 0 is +Y");
    metadata.emplace_back("hairbake:latlong", "gltf: centre column +X, right of it +Z");
    files.push_back(write_picture(folder / (name + "_latlong.exr"), picture.pixels, picture.width, picture.height,
                                  metadata, primaries, "lat-long, gltf convention"));
}

}  // namespace

std::vector<WrittenFile> write_map_exr(const MapSet& maps, const NamedPrimaries& primaries,
                                       const std::filesystem::path& folder, Progress& progress) {
    std::vector<WrittenFile> files;
    for (const MapLobe& lobe : maps.lobes)
        for (std::size_t i = 0; i < lobe.cubes.size(); ++i) {
            progress.check();
            Metadata metadata = map_metadata(maps, lobe.label(i));
            metadata.emplace_back("hairbake:primaries", primaries.name);
            if (lobe.has_slices())
                metadata.emplace_back("hairbake:thetaPrimeDeg", number_text(lobe.theta_prime_deg[i / lobe.orders]));
            write_one_map(lobe.cubes[i], maps.face_size, folder, lobe.file_name(i), metadata, primaries.xy, files);
        }
    return files;
}

WrittenFile write_environment_sh(const IrradianceFacts& facts, const NamedPrimaries& primaries,
                                 const std::filesystem::path& folder) {
    FileSink sink(folder / "environment_sh.json");
    sink.write(
        "{\n  \"content\": \"real orthonormal spherical harmonics of the environment's radiance, RGB\",\n"
        "  \"order\": \"index l*l + l + m, z polar, no Condon-Shortley phase, hairbake's frame\",\n"
        "  \"primaries\": \"" +
        primaries.name + "\",\n  \"bands\": " + std::to_string(facts.environment_sh_bands) +
        ",\n  \"coefficients\": [");
    const char* separator = "\n    ";
    for (const Vec3d& c : facts.environment_sh) {
        char entry[128];
        std::snprintf(entry, sizeof entry, "%s[%.17g, %.17g, %.17g]", separator, c.x, c.y, c.z);
        sink.write(std::string_view(entry));
        separator = ",\n    ";
    }
    sink.write("\n  ]\n}\n");
    WrittenFile written = sink.finish();
    written.shape = {facts.environment_sh.size(), 3};
    written.content = "SH coefficients of the environment";
    return written;
}

std::vector<WrittenFile> write_exr(const OutputContext& context, const StagePart& part) {
    if (!part.maps) return {};
    return write_map_exr(*part.maps, context.result.inputs.environment->primaries, context.folder, context.progress);
}

std::vector<WrittenFile> write_environment_harmonics(const OutputContext& context, const StagePart& part) {
    const auto* facts = std::get_if<IrradianceFacts>(&part.facts);
    if (!facts) return {};
    return {write_environment_sh(*facts, context.result.inputs.environment->primaries, context.folder)};
}

}  // namespace hairbake
