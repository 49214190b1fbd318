#include "core/environment/environment_assembly.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>

#include "core/base/assert.h"
#include "core/base/parallel.h"
#include "core/environment/cube_layout.h"
#include "core/environment/image_file.h"

namespace hairbake {
namespace {

constexpr int largest_face = 4096, widest_latlong = 16384;
constexpr std::int64_t most_pixels = std::int64_t(1) << 27;

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what) {
    throw Error(ErrorKind::bad_input, file.string() + ": " + what);
}

std::string size_text(int width, int height) { return std::to_string(width) + " x " + std::to_string(height); }

std::string fault_of_face(int width, int height) {
    if (width != height || width < 1)
        return "the size is " + size_text(width, height) + " pixels; a face of a cube map is square (layout faces)";
    if (width > largest_face)
        return "the declared size is " + size_text(width, height) + " pixels; allowed are faces up to " +
               size_text(largest_face, largest_face);
    return {};
}

// IEC 61966-2-1.
float srgb_to_linear(float v) { return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f); }

void linearize(std::vector<Vec3f>& pixels, const Progress& progress) {
    parallel_for(pixels.size(), 1 << 16, [&](std::size_t begin, std::size_t end) {
        progress.check();
        for (std::size_t i = begin; i < end; ++i)
            pixels[i] = {srgb_to_linear(pixels[i].x), srgb_to_linear(pixels[i].y), srgb_to_linear(pixels[i].z)};
    });
}

NamedPrimaries primaries_of(const ImageFile& image) {
    if (!image.chromaticities) return {};
    return {name_of(*image.chromaticities), image.chromaticities};
}

// Takes over the facts of a file beside its pixels. A warning of several files appears once.
void take_facts(ImageFile& image, EnvironmentMap& map, const Progress& progress) {
    map.source_format = image.format;
    map.primaries = primaries_of(image);
    if (image.integer) {
        map.low_dynamic_range = true;
        image.warnings.push_back(
            "the image holds integers: decoded as sRGB, its dynamic range is low and lamps are clipped");
        linearize(image.pixels, progress);
    }
    for (const std::string& warning : image.warnings)
        if (std::find(map.warnings.begin(), map.warnings.end(), warning) == map.warnings.end())
            map.warnings.push_back(warning);
}

void become_cube(EnvironmentMap& map, int size) {
    map.shape = EnvironmentShape::cube;
    map.width = size;
    map.height = cube_faces * size;
}

// OpenEXR's own cube maps (ImfEnvmap.h) are vertical strips whose faces are mirror images of OpenGL's: left to right on
// the sides, upside down on +Y and -Y. The layout vertical_strip takes them as OpenGL's.
void turn_openexr_cube(EnvironmentLayout requested, EnvironmentMap& map) {
    if (requested == EnvironmentLayout::vertical_strip) {
        map.warnings.push_back(
            "the EXR envmap attribute says cube map, whose faces OpenEXR orients in another way: they were taken in "
            "the orientation of OpenGL, as vertical_strip asks");
        return;
    }
    const int size = map.width;
    for (int face = 0; face < cube_faces; ++face) {
        const bool is_vertical = face / 2 == 1;
        Vec3f* first = map.pixels.data() + std::size_t(face) * size * size;
        for (int row = 0; row < size; ++row) {
            Vec3f* line = first + std::size_t(row) * size;
            if (!is_vertical)
                std::reverse(line, line + size);
            else if (row < size / 2)
                std::swap_ranges(line, line + size, first + std::size_t(size - 1 - row) * size);
        }
    }
    map.warnings.push_back(
        "the EXR envmap attribute says cube map: its faces were turned to the orientation of OpenGL, and its samples "
        "on the faces' edges were taken as half a texel inside");
}

// A photo of 4:3 has the shape of a cross. Outside the faces of a cross there is one colour.
bool has_picture_outside_faces(const CubeLayout& layout, int size, const std::vector<Vec3f>& pixels) {
    std::vector<std::uint8_t> used(std::size_t(layout.columns) * layout.rows, 0);
    for (const FacePlace& place : layout.faces) used[std::size_t(place.row) * layout.columns + place.column] = 1;
    const std::size_t width = std::size_t(layout.columns) * size;
    const Vec3f* first = nullptr;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        if (used[i / width / size * layout.columns + i % width / size]) continue;
        if (!first) first = &pixels[i];
        if (std::memcmp(&pixels[i], first, sizeof *first) != 0) return true;  // NaN is a colour here too
    }
    return false;
}

/// Gets the pixels or the facts of a file: file index, check of its declared size.
using ReadFile = std::function<ImageFile(std::size_t index, const SizeCheck& check)>;

ImageFile read_one_picture(const std::filesystem::path& file, EnvironmentLayout requested, const ReadFile& read) {
    if (requested == EnvironmentLayout::faces)
        fail(file, "this is one picture; layout faces takes a folder with six, or a pattern with {face}");
    return read(0, [&](int width, int height) { return fault_of_size(requested, width, height); });
}

/// Reads the six faces and gives each to `take`. They must be square and agree in size and primaries.
void read_six_faces(const EnvironmentFiles& files, EnvironmentLayout requested, const ReadFile& read,
                    const std::function<void(ImageFile&)>& take) {
    if (requested != EnvironmentLayout::automatic && requested != EnvironmentLayout::faces)
        fail(files.files[0].parent_path(),
             "these are six pictures; layout " + std::string(name_of(requested)) + " takes one");
    const std::string first = files.files[0].string();
    int size = 0;
    std::string primaries;
    for (std::size_t face = 0; face < files.files.size(); ++face) {
        ImageFile image = read(face, [&](int width, int height) {
            if (face == 0 || width != height || width == size) return fault_of_face(width, height);
            return "the size is " + size_text(width, height) + " pixels; that of " + first + " is " +
                   size_text(size, size);
        });
        const std::string found = primaries_of(image).name;
        if (face > 0 && found != primaries)
            fail(files.files[face], "the primaries are " + found + "; those of " + first + " are " + primaries);
        size = image.width;
        primaries = found;
        take(image);
    }
}

EnvironmentMap assemble_picture(const std::filesystem::path& file, EnvironmentLayout requested, Progress& progress) {
    ProgressPart reading = progress.part(0, 0.9);
    ImageFile image = read_one_picture(
        file, requested, [&](std::size_t, const SizeCheck& check) { return read_image_file(file, check, reading); });
    EnvironmentMap map;
    take_facts(image, map, progress);
    map.layout = layout_of_shape(image.width, image.height).value();  // `check` let no other shape pass
    const CubeLayout* layout = find_cube_layout(map.layout);
    if (!layout) {
        map.width = image.width;
        map.height = image.height;
        map.pixels = std::move(image.pixels);
        if (image.envmap == OpenExrEnvironment::latlong) map.latlong = LatLong::openexr;
        return map;
    }
    become_cube(map, image.width / layout->columns);
    if (requested == EnvironmentLayout::automatic && has_picture_outside_faces(*layout, map.width, image.pixels))
        map.warnings.push_back("the picture was taken as a " + std::string(name_of(map.layout)) + " for its shape (" +
                               size_text(image.width, image.height) +
                               "), but it has a picture outside the faces too: is it a photo?");
    map.pixels = take_cube(*layout, map.width, image.pixels);
    if (image.envmap == OpenExrEnvironment::cube && map.layout == EnvironmentLayout::vertical_strip)
        turn_openexr_cube(requested, map);
    return map;
}

EnvironmentMap assemble_faces(const EnvironmentFiles& files, EnvironmentLayout requested, Progress& progress) {
    EnvironmentMap map;
    map.layout = EnvironmentLayout::faces;
    int size = 0;
    const auto read = [&](std::size_t face, const SizeCheck& check) {
        ProgressPart reading = progress.part(0.15 * double(face), 0.15 * double(face + 1));
        return read_image_file(files.files[face], check, reading);
    };
    read_six_faces(files, requested, read, [&](ImageFile& image) {
        take_facts(image, map, progress);
        size = image.width;
        map.pixels.reserve(std::size_t(cube_faces) * size * size);
        map.pixels.insert(map.pixels.end(), image.pixels.begin(), image.pixels.end());
    });
    become_cube(map, size);
    return map;
}

}  // namespace

std::string fault_of_size(EnvironmentLayout requested, int width, int height) {
    HAIRBAKE_ASSERT(requested != EnvironmentLayout::faces);
    const std::optional<EnvironmentLayout> found = layout_of_shape(width, height);
    const std::string size = size_text(width, height) + " pixels";
    if (!found) return "the size is " + size + ", the shape of no layout; known are " + known_shapes();
    if (requested != EnvironmentLayout::automatic && requested != *found)
        return "the size is " + size + ", the shape of layout " + std::string(name_of(*found)) + " and not of " +
               std::string(name_of(requested)) + "; known are " + known_shapes();
    const CubeLayout* layout = find_cube_layout(*found);
    if (!layout && width > widest_latlong)
        return "the declared size is " + size + "; allowed is up to " + size_text(widest_latlong, widest_latlong / 2);
    if (layout && (width / layout->columns > largest_face || std::int64_t(width) * height > most_pixels))
        return "the declared size is " + size + ", faces of " + std::to_string(width / layout->columns) +
               "; allowed are faces up to " + std::to_string(largest_face) + " and " + std::to_string(most_pixels) +
               " pixels";
    return {};
}

EnvironmentMap assemble_environment(const EnvironmentFiles& files, EnvironmentLayout requested, Progress& progress) {
    return files.faces() ? assemble_faces(files, requested, progress)
                         : assemble_picture(files.files[0], requested, progress);
}

void check_pictures(const EnvironmentFiles& files, EnvironmentLayout requested) {
    const auto read = [&](std::size_t index, const SizeCheck& check) {
        return read_image_facts(files.files[index], check);
    };
    if (files.faces())
        read_six_faces(files, requested, read, [](ImageFile&) {});
    else
        read_one_picture(files.files[0], requested, read);
}

}  // namespace hairbake
