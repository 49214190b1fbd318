#include "core/output/map_files.h"

#include <cstdio>

#include "core/output/image_file.h"
#include "core/output/latlong_picture.h"
#include "core/output/map_metadata.h"
#include "core/output/npy.h"

namespace hairbake {
namespace {

WrittenFile write_exr(const std::filesystem::path& file, const std::vector<Vec3f>& pixels, int width, int height,
                      const Metadata& metadata, const std::string& content) {
    FileSink sink(file);
    sink.write(encode_exr(pixels, width, height, metadata));
    WrittenFile written = sink.finish();
    written.shape = {static_cast<std::size_t>(height), static_cast<std::size_t>(width), 3};
    written.content = content;
    return written;
}

void write_one_map(const IrradianceMaps& maps, const CubeTexels& cube, const std::filesystem::path& folder,
                   const std::string& name, Metadata metadata, std::vector<WrittenFile>& files) {
    const int n = maps.face_size;
    Metadata strip = metadata;
    strip.emplace_back("hairbake:layout", "vertical strip of cube faces, OpenGL orientation, rows from the top");
    strip.emplace_back("hairbake:faceOrder", "+X -X +Y -Y +Z -Z");
    files.push_back(write_exr(folder / (name + ".exr"), cube, n, 6 * n, strip, "cube faces in a vertical strip"));

    const Picture picture = to_latlong(cube, n, 4 * n);
    metadata.emplace_back("hairbake:layout", "lat-long, row 0 is +Y");
    metadata.emplace_back("hairbake:latlong", "gltf: centre column +X, right of it +Z");
    files.push_back(write_exr(folder / (name + "_latlong.exr"), picture.pixels, picture.width, picture.height, metadata,
                              "lat-long, gltf convention"));
}

}  // namespace

std::vector<WrittenFile> write_map_npy(const IrradianceMaps& maps, const std::filesystem::path& folder) {
    const auto n = static_cast<std::size_t>(maps.face_size);
    FileSink diffuse(folder / "diffuse.npy");
    const std::vector<std::size_t> diffuse_shape{6, n, n, 3};
    diffuse.write(npy_header(diffuse_shape));
    diffuse.write(npy_data(maps.diffuse));

    FileSink specular(folder / "specular.npy");
    const std::vector<std::size_t> specular_shape{maps.specular.size(), 6, n, n, 3};
    specular.write(npy_header(specular_shape));
    for (const CubeTexels& map : maps.specular) specular.write(npy_data(map));

    std::vector<WrittenFile> files{diffuse.finish(), specular.finish()};
    files[0].shape = diffuse_shape;
    files[0].content = "diffuse map: face, row, column, RGB";
    files[1].shape = specular_shape;
    files[1].content = "specular maps: theta', face, row, column, RGB";
    return files;
}

std::vector<WrittenFile> write_map_exr(const IrradianceMaps& maps, const std::filesystem::path& folder,
                                       Progress& progress) {
    std::vector<WrittenFile> files;
    write_one_map(maps, maps.diffuse, folder, "diffuse", map_metadata(maps, "diffuse"), files);
    for (std::size_t m = 0; m < maps.specular.size(); ++m) {
        progress.check();
        Metadata metadata = map_metadata(maps, "specular " + std::to_string(m));
        metadata.emplace_back("hairbake:thetaPrimeDeg", number_text(theta_prime_degrees(maps, m)));
        write_one_map(maps, maps.specular[m], folder, specular_name(maps, m), metadata, files);
    }
    return files;
}

WrittenFile write_environment_sh(const IrradianceMaps& maps, const std::filesystem::path& folder) {
    FileSink sink(folder / "environment_sh.json");
    sink.write(
        "{\n  \"content\": \"real orthonormal spherical harmonics of the environment's radiance, RGB\",\n"
        "  \"order\": \"index l*l + l + m, z polar, no Condon-Shortley phase, hairbake's frame\",\n"
        "  \"bands\": " +
        std::to_string(maps.environment_sh_bands) + ",\n  \"coefficients\": [");
    const char* separator = "\n    ";
    for (const Vec3d& c : maps.environment_sh) {
        char entry[128];
        std::snprintf(entry, sizeof entry, "%s[%.17g, %.17g, %.17g]", separator, c.x, c.y, c.z);
        sink.write(std::string_view(entry));
        separator = ",\n    ";
    }
    sink.write("\n  ]\n}\n");
    WrittenFile written = sink.finish();
    written.shape = {maps.environment_sh.size(), 3};
    written.content = "SH coefficients of the environment";
    return written;
}

}  // namespace hairbake
