// Maps that hold the labelled cube: whichever file they are read back from, each direction shows its own label.
#include <gtest/gtest.h>

#include "core/environment/environment_reader.h"
#include "core/output/map_files.h"
#include "tests/core/output/small_result.h"
#include "tests/support/labelled_cube.h"
#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

using test_support::TemporaryFolder;

MapSet labelled_maps(int size) {
    MapSet maps = *test_support::small_result().parts[1].maps;
    maps.face_size = size;
    for (MapLobe& lobe : maps.lobes)
        for (CubeTexels& cube : lobe.cubes) cube = labelled_cube(size);
    return maps;
}

// Faces' lower middles, edges and corners, away from where colours change (labelled_cube.h).
void expect_labelled(const EnvironmentMap& map) {
    for (const Vec3d& d : labelled_directions())
        EXPECT_LT(length(texel_towards(map, d) - labelled_colour(d)), 1e-6)
            << name_of(map.layout) << ": " << d.x << ' ' << d.y << ' ' << d.z;
}

TEST(LabelledMaps, StripAndLatLongShowEveryDirectionItsOwnLabel) {
    // The files of a result are themselves environments: the strip in the layout vertical_strip, the lat-long in the
    // convention gltf, which `auto` and the default take them for.
    const TemporaryFolder folder;
    BakeProgress progress;
    const MapSet maps = labelled_maps(64);
    write_map_exr(maps, {}, folder / "", progress);
    for (const char* name : {"diffuse", "specular_00"}) {
        const EnvironmentMap strip = read_environment(folder / (std::string(name) + ".exr"), {}, progress);
        EXPECT_EQ(strip.layout, EnvironmentLayout::vertical_strip);
        EXPECT_EQ(strip.pixels, maps.lobes[0].cubes[0]);
        expect_labelled(strip);
        const EnvironmentMap latlong = read_environment(folder / (std::string(name) + "_latlong.exr"), {}, progress);
        EXPECT_EQ(latlong.layout, EnvironmentLayout::latlong);
        expect_labelled(latlong);
    }
}

}  // namespace
}  // namespace hairbake
