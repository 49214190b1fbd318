// The half-float containers of maps, read back by ktx-parse, nvddsinfo and numpy (check_half_maps.py).
#include <gtest/gtest.h>

#include <cmath>
#include <ostream>

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/output/array_files.h"
#include "core/output/dds_files.h"
#include "core/output/half.h"
#include "core/output/ktx2_files.h"
#include "core/output/map_metadata.h"
#include "core/output/raw_maps.h"
#include "tests/support/labelled_cube.h"
#include "tests/support/run_program.h"
#include "tests/support/source_tree.h"
#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

using test_support::run_program;
using test_support::TemporaryFolder;

MapSet maps_of(int face_size, const std::vector<CubeTexels>& cubes) {
    IrradianceMaps maps;
    maps.face_size = face_size;
    maps.exponent = 64;
    maps.diffuse = cubes.at(0);
    maps.specular.assign(cubes.begin() + 1, cubes.end());
    return to_map_set(maps, FiberSettings{});
}

/// Every texel and channel distinct, over five decades below `largest`, which one of them is.
CubeTexels random_cube(int face_size, float largest, std::uint64_t seed) {
    Random random(seed);
    const auto value = [&] { return largest * static_cast<float>(std::pow(10, -5 * random.next())); };
    CubeTexels cube;
    for (int i = 0; i < 6 * face_size * face_size; ++i) cube.emplace_back(value(), value(), value());
    cube[7].y = largest;
    return cube;
}

MapSet random_maps(int face_size, float largest) {
    return maps_of(face_size, {random_cube(face_size, largest, 1), random_cube(face_size, largest / 3, 2),
                               random_cube(face_size, largest, 3), random_cube(face_size, largest / 100, 4)});
}

struct Container {
    std::string name;
    std::vector<WrittenFile> (*write)(const MapSet&, const std::filesystem::path&, Progress&);
};
void PrintTo(const Container& container, std::ostream* stream) { *stream << container.name; }

std::vector<WrittenFile> ktx2(const MapSet& maps, const std::filesystem::path& folder, Progress& progress) {
    return write_map_ktx2(maps, "Rec.2020", folder, progress);
}
std::vector<WrittenFile> raw(const MapSet& maps, const std::filesystem::path& folder, Progress& progress) {
    return write_map_raw(maps, "Rec.2020", folder, progress);
}

class HalfMaps : public testing::TestWithParam<Container> {
protected:
    /// What check_half_maps.py prints about the container written of `maps`.
    std::string read_back(const MapSet& maps, double scale, const std::string& more = "") {
        const TemporaryFolder folder;
        BakeProgress progress;
        write_map_npy(maps, folder / "");
        for (const WrittenFile& file : GetParam().write(maps, folder / "", progress))
            EXPECT_EQ(file.scale, file.name == "maps.json" ? std::nullopt : std::optional(scale)) << file.name;
        return run_program("/usr/bin/python3 " + test_support::source_file("tests/core/output/check_half_maps.py") +
                           " " + GetParam().name + " " + (folder / "").string() + " " + number_text(scale) + " " +
                           more + " 2>&1")
            .output;
    }
};

TEST_P(HalfMaps, HoldTheLabelledCubeTheRightWayUp) {
    // Faces of 22, the labels' own size: halves hold all of its values exactly.
    const CubeTexels cube = labelled_cube(22);
    EXPECT_EQ(read_back(maps_of(22, {cube, cube, cube}), 1, "labelled"), "read, oriented\n");
}

TEST_P(HalfMaps, HoldEveryTexelOfRandomMapsToTheNearestHalf) {
    EXPECT_EQ(read_back(random_maps(16, 1000), 1), "read\n");
    EXPECT_EQ(read_back(random_maps(7, 1000), 1), "read\n");
}

TEST_P(HalfMaps, HoldRadianceBeyond65504WithAScale) {
    // 1e7 / 65504 = 152.7: the next power of two is 256.
    EXPECT_EQ(read_back(random_maps(8, 1e7f), 256), "read\n");
}

TEST_P(HalfMaps, HoldFaintRadianceWithAScale) {
    // 1e-3 * 2^25 = 33554 lies in (32752, 65504].
    EXPECT_EQ(read_back(random_maps(8, 1e-3f), std::ldexp(1.0, -25)), "read\n");
}

TEST_P(HalfMaps, RefuseMapsThatAreNotFiniteAndSayWhere) {
    const TemporaryFolder folder;
    BakeProgress progress;
    MapSet maps = random_maps(4, 1);
    maps.lobes[1].cubes[1][(2 * 4 + 3) * 4 + 1].z = NAN;
    try {
        GetParam().write(maps, folder / "", progress);
        ADD_FAILURE() << "was written";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::bad_input);
        EXPECT_NE(std::string(error.what()).find("specular 1 map: face +Y, row 3, column 1"), std::string::npos)
            << error.what();
    }
}

INSTANTIATE_TEST_SUITE_P(Containers, HalfMaps,
                         testing::Values(Container{"ktx2", ktx2}, Container{"dds", write_map_dds},
                                         Container{"raw", raw}),
                         [](const auto& container) { return container.param.name; });

TEST(DdsFiles, NvddsinfoSeesACubeOfHalfFloatsWithAllLevels) {
    const TemporaryFolder folder;
    BakeProgress progress;
    EXPECT_EQ(write_map_dds(random_maps(16, 1), folder / "", progress).size(), 4u);
    for (const char* name : {"diffuse.dds", "specular_02.dds"}) {
        const auto info = run_program("nvddsinfo " + (folder / name).string() + " 2>&1");
        EXPECT_EQ(info.exit_code, 0);
        for (const char* piece : {"Height: 16", "Width: 16", "Mipmap count: 5", "'DX10'", "DDSCAPS2_CUBEMAP_ALL_FACES",
                                  "(R16G16B16A16_FLOAT)", "(TEXTURE2D)", "Misc flag: 4", "Array size: 1"})
            EXPECT_NE(info.output.find(piece), std::string::npos) << piece << " is not in\n" << info.output;
    }
}

}  // namespace
}  // namespace hairbake
