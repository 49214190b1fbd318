// The labelled cube, written in every layout and convention by OpenImageIO and pasted together by oiiotool, lands
// right.
#include "core/environment/cube_layout.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "core/environment/environment_reader.h"
#include "tests/support/labelled_cube.h"
#include "tests/support/labelled_pictures.h"
#include "tests/support/make_map.h"
#include "tests/support/run_program.h"
#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

using test_support::run_program;
using test_support::TemporaryFolder;

constexpr int size = 32;

const std::vector<std::string> cube_names{"horizontal_cross", "vertical_cross", "horizontal_strip", "vertical_strip"};

void save(const std::filesystem::path& file, const LabelledPicture& picture,
          const std::function<void(OIIO::ImageSpec&)>& change = {}) {
    OIIO::ImageSpec spec(picture.width, picture.height, 3, OIIO::TypeDesc::FLOAT);
    if (change) change(spec);
    const auto output = OIIO::ImageOutput::create(file.string());
    ASSERT_TRUE(output && output->open(file.string(), spec)) << OIIO::geterror();
    ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, picture.pixels.data())) << output->geterror();
    ASSERT_TRUE(output->close());
}

EnvironmentMap read(const std::filesystem::path& path, const std::string& layout = "auto",
                    LatLong convention = LatLong::gltf, const std::array<double, 3>& rotation = {}) {
    EnvironmentSettings settings;
    settings.layout = find_in(environment_layout_names, layout).value();
    settings.latlong = convention;
    settings.rotation_deg = rotation;
    Progress progress;
    return read_environment(path, settings, progress);
}

std::string refusal(const std::filesystem::path& path, const std::string& layout = "auto") {
    try {
        read(path, layout);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::bad_input);
        return error.what();
    }
    return "taken";
}

// The directions are far from where colours change: 3 texels of the cube, 2 of the lat-long map.
void expect_labelled(const EnvironmentMap& map, const Matrix3& rotation = rotation_matrix({})) {
    for (const Vec3d& d : labelled_directions())
        EXPECT_EQ(texel_towards(map, transform(rotation, d)), labelled_colour(d))
            << name_of(map.layout) << ": " << d.x << ' ' << d.y << ' ' << d.z;
}

TEST(LabelledCube, ItsColoursTellEveryDirectionOfTheTestApart) {
    // By hand: +X is red, the edge of -Y and +Z dark green and blue, the corner of all three positive axes white. The
    // 27 combinations of three levels but the middle of the cube itself: 26 colours.
    EXPECT_EQ(labelled_colour({1, 0.1, -0.2}), (Vec3f{1, 0.5f, 0.5f}));
    EXPECT_EQ(labelled_colour({0, -1, 0.9}), (Vec3f{0.5f, 1 / 16.0f, 1}));
    EXPECT_EQ(labelled_colour({3, 3.1, 2.9}), (Vec3f{1, 1, 1}));
    std::set<std::array<float, 3>> colours;
    for (const Vec3d& d : labelled_directions()) {
        const Vec3f c = labelled_colour(d);
        colours.insert({c.x, c.y, c.z});
        if (c != labelled_radiance(d)) ADD_FAILURE() << "a label covers " << d.x << ' ' << d.y << ' ' << d.z;
    }
    EXPECT_EQ(colours.size(), 26u);
}

TEST(LabelledCube, EveryTurnAndMirrorOfAFaceShows) {
    // The eight symmetries of the square change the face, as docs/formats.md says of the pictures.
    for (int face = 0; face < cube_faces; ++face) {
        const LabelledPicture picture = labelled_face(face, size);
        std::set<std::vector<float>> pictures;
        for (int symmetry = 0; symmetry < 8; ++symmetry) {
            std::vector<float> values;
            for (int y = 0; y < size; ++y)
                for (int x = 0; x < size; ++x) {
                    const int u = symmetry & 1 ? size - 1 - x : x, v = symmetry & 2 ? size - 1 - y : y;
                    const Vec3f p = picture.pixels[symmetry & 4 ? u * size + v : v * size + u];
                    values.insert(values.end(), {p.x, p.y, p.z});
                }
            pictures.insert(values);
        }
        EXPECT_EQ(pictures.size(), 8u) << cube_face_name(face);
    }
}

TEST(CubeLayout, EveryPictureOfTheLabelledCubeGivesTheSameCube) {
    // Texel by texel against labelled_cube, which draws from the directions of cube_map.h. Around a cross lies NaN: it
    // is not looked at. Six colours and two labels are exact in EXR.
    const TemporaryFolder folder;
    const CubeTexels expected = labelled_cube(size);
    for (const std::string& name : cube_names) {
        save(folder / (name + ".exr"), labelled_picture(name, size, std::numeric_limits<float>::quiet_NaN()));
        for (const std::string& layout : {std::string("auto"), name}) {
            const EnvironmentMap map = read(folder / (name + ".exr"), layout);
            EXPECT_EQ(name_of(map.layout), name);
            EXPECT_EQ(map.shape, EnvironmentShape::cube);
            EXPECT_EQ(map.width, size);
            EXPECT_EQ(map.height, 6 * size);
            EXPECT_EQ(map.pixels, expected) << name;
            EXPECT_TRUE(map.warnings.empty());
            expect_labelled(map);
        }
    }
}

TEST(CubeLayout, SixFacesGiveTheSameCube) {
    const TemporaryFolder folder;
    const std::array<const char*, 6> names{"right", "left", "top", "bottom", "front", "back"};
    std::filesystem::create_directory(folder / "sky");
    for (int face = 0; face < cube_faces; ++face)
        save(folder / "sky" / (std::string(names[face]) + ".exr"), labelled_face(face, size));
    for (const std::filesystem::path& path : {folder / "sky", folder / "sky" / "{face}.exr"})
        for (const std::string layout : {"auto", "faces"}) {
            const EnvironmentMap map = read(path, layout);
            EXPECT_EQ(map.layout, EnvironmentLayout::faces);
            EXPECT_EQ(map.pixels, labelled_cube(size));
            expect_labelled(map);
        }
}

TEST(CubeLayout, LatLongMapsOfEveryConventionShowTheSameLabels) {
    const TemporaryFolder folder;
    for (const LatLong convention : {LatLong::gltf, LatLong::filament, LatLong::openexr}) {
        save(folder / "a.hdr", labelled_picture(name_of(convention), size));  // RGBE holds the colours exactly
        const EnvironmentMap map = read(folder / "a.hdr", "auto", convention);
        EXPECT_EQ(map.layout, EnvironmentLayout::latlong);
        expect_labelled(map);
    }
}

TEST(CubeLayout, OiiotoolPastesFacesToTheSamePictures) {
    // (--paste takes the foreground below the background on its stack.) Independent of both our tables: faces pasted by
    // oiiotool at the places that the table of docs/formats.md names, -Z of the vertical cross turned by oiiotool.
    const TemporaryFolder folder;
    const auto face = [&](int k) { return (folder / ("face" + std::to_string(k) + ".exr")).string(); };
    for (int k = 0; k < cube_faces; ++k) save(face(k), labelled_face(k, size));
    const auto paste = [&](const std::string& name, int columns, int rows,
                           const std::array<std::pair<int, int>, 6>& places, bool turn_last) {
        std::string command =
            "oiiotool --create " + std::to_string(columns * size) + "x" + std::to_string(rows * size) + " 3";
        for (int k = 0; k < cube_faces; ++k) {
            command.append(" ").append(face(k)).append(k == 5 && turn_last ? " --rotate180" : "");
            command.append(" --swap --paste +").append(std::to_string(places[k].first * size));
            command.append("+").append(std::to_string(places[k].second * size));
        }
        const auto finished = run_program(command + " -d float -o " + (folder / name).string() + " 2>&1");
        ASSERT_EQ(finished.exit_code, 0) << finished.output;
        EXPECT_EQ(read(folder / name).pixels, labelled_cube(size)) << name;
    };
    paste("h.exr", 4, 3, {{{2, 1}, {0, 1}, {1, 0}, {1, 2}, {1, 1}, {3, 1}}}, false);
    paste("v.exr", 3, 4, {{{2, 1}, {0, 1}, {1, 0}, {1, 2}, {1, 1}, {1, 3}}}, true);
    paste("hs.exr", 6, 1, {{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}}}, false);
    paste("vs.exr", 1, 6, {{{0, 0}, {0, 1}, {0, 2}, {0, 3}, {0, 4}, {0, 5}}}, false);
}

TEST(CubeLayout, RotationTurnsACubeAsItTurnsALatLongMap) {
    const TemporaryFolder folder;
    save(folder / "cube.exr", labelled_picture("horizontal_cross", size));
    save(folder / "latlong.exr", labelled_picture("gltf", size));
    const std::array<double, 3> angles{25, -130, 70};
    for (const char* name : {"cube.exr", "latlong.exr"})
        expect_labelled(read(folder / name, "auto", LatLong::gltf, angles), rotation_matrix(angles));
}

TEST(CubeLayout, DirectionsAndPointsOfACubeAreInverse) {
    EnvironmentMap map;
    map.shape = EnvironmentShape::cube;
    map.width = 5;
    map.height = 30;
    map.rotation = rotation_matrix({10, 20, 30});
    double sum = 0;
    const TexelSolidAngles omega = texel_solid_angles(map);
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x) {
            const Vec3d d = direction_of(map, {x + 0.5, y + 0.5});
            EXPECT_NEAR(length(d), 1, 1e-15);
            const MapPoint back = point_of(map, d);
            EXPECT_NEAR(back.x, x + 0.5, 1e-13);
            EXPECT_NEAR(back.y, y + 0.5, 1e-13);
            sum += omega.at(x, y);
        }
    EXPECT_NEAR(sum, 4 * 3.14159265358979324, 1e-12);
    EXPECT_EQ(place_of_texel(map, 5 * 27 + 3), "pixel (3, 2) of face -Z");
}

TEST(CubeLayout, AConventionOfLatLongsIsNotUsedForACubeAndSaysSo) {
    const TemporaryFolder folder;
    save(folder / "a.exr", labelled_picture("vertical_cross", size));
    const EnvironmentMap map = read(folder / "a.exr", "auto", LatLong::openexr);
    expect_labelled(map);
    ASSERT_EQ(map.warnings.size(), 1u);
    EXPECT_NE(map.warnings[0].find("environment_settings.latlong is openexr"), std::string::npos);
}

TEST(CubeLayout, ShapesAndLayoutsThatDoNotFitAreRefusedWithWhatIsKnown) {
    const TemporaryFolder folder;
    const LabelledPicture cross = labelled_picture("horizontal_cross", size);
    save(folder / "cross.exr", cross);
    EXPECT_NE(
        refusal(folder / "cross.exr", "vertical_cross").find("shape of layout horizontal_cross and not of vertical"),
        std::string::npos);
    EXPECT_NE(refusal(folder / "cross.exr", "latlong").find("not of latlong"), std::string::npos);
    EXPECT_NE(refusal(folder / "cross.exr", "faces").find("one picture"), std::string::npos);
    save(folder / "odd.exr", {127, 96, std::vector<Vec3f>(127 * 96)});  // nearly 4:3
    const std::string odd = refusal(folder / "odd.exr");
    for (const char* piece : {"127 x 96", "2:1 (latlong)", "4:3 (horizontal_cross)", "3:4 (vertical_cross)",
                              "6:1 (horizontal_strip)", "1:6 (vertical_strip)", "{face}"})
        EXPECT_NE(odd.find(piece), std::string::npos) << piece << " is not in " << odd;
}

// Where OpenEXR puts the light of a direction in its own cube maps: ImfEnvmap.h gives a point (a, b) of [-1, 1]^2 on
// each face, and the pixel's place from the left and from the top, in units of the face.
struct OpenExrPlace {
    int face;
    double from_left, from_top;
};

OpenExrPlace openexr_place(const Vec3d& d) {
    const double x = std::abs(d.x), y = std::abs(d.y), z = std::abs(d.z), largest = std::max({x, y, z});
    const Vec3d p = (d / largest + Vec3d(1)) / 2.0;  // 0 to 1 in each coordinate
    if (x == largest) return d.x > 0 ? OpenExrPlace{0, p.z, 1 - p.y} : OpenExrPlace{1, 1 - p.z, 1 - p.y};
    if (y == largest) return d.y > 0 ? OpenExrPlace{2, p.x, 1 - p.z} : OpenExrPlace{3, p.x, p.z};
    return d.z > 0 ? OpenExrPlace{4, 1 - p.x, 1 - p.y} : OpenExrPlace{5, p.x, 1 - p.y};
}

TEST(CubeLayout, OpenExrsOwnCubeIsTurnedUnlessTheStripIsAskedForByName) {
    const TemporaryFolder folder;
    LabelledPicture openexr{size, 6 * size, std::vector<Vec3f>(std::size_t(6) * size * size)};
    const EnvironmentMap cube = testing::make_cube(size, [](const Vec3d& d) { return Vec3d(labelled_radiance(d)); });
    for (int row = 0; row < cube.height; ++row)
        for (int column = 0; column < size; ++column) {
            const OpenExrPlace place = openexr_place(direction_of(cube, {column + 0.5, row + 0.5}));
            const int x = int(place.from_left * size), y = int(place.from_top * size);
            openexr.pixels[(std::size_t(place.face) * size + y) * size + x] =
                cube.pixels[std::size_t(row) * size + column];
        }
    const auto says_cube = [](OIIO::ImageSpec& spec) { spec.attribute("textureformat", "CubeFace Environment"); };
    save(folder / "a.exr", openexr, says_cube);
    const EnvironmentMap turned = read(folder / "a.exr");
    expect_labelled(turned);
    ASSERT_EQ(turned.warnings.size(), 1u);
    EXPECT_NE(turned.warnings[0].find("turned to the orientation of OpenGL"), std::string::npos);

    save(folder / "b.exr", labelled_picture("vertical_strip", size), says_cube);
    const EnvironmentMap as_asked = read(folder / "b.exr", "vertical_strip");
    expect_labelled(as_asked);
    ASSERT_EQ(as_asked.warnings.size(), 1u);
    EXPECT_NE(as_asked.warnings[0].find("as vertical_strip asks"), std::string::npos);
}

TEST(CubeLayout, APhotoWithTheShapeOfACrossIsWarnedOf) {
    const TemporaryFolder folder;
    const auto photo_warnings = [&](const char* name, const char* layout, bool photo) {
        LabelledPicture picture = labelled_picture(name, size);
        if (photo) picture.pixels.back() = picture.pixels.back() + Vec3f(0.25f);  // outside the faces of both crosses
        save(folder / "a.exr", picture);
        return read(folder / "a.exr", layout).warnings;
    };
    for (const char* cross : {"horizontal_cross", "vertical_cross"}) {
        EXPECT_TRUE(photo_warnings(cross, "auto", false).empty());
        const auto warnings = photo_warnings(cross, "auto", true);
        ASSERT_EQ(warnings.size(), 1u);
        EXPECT_NE(warnings[0].find("is it a photo?"), std::string::npos);
        EXPECT_TRUE(photo_warnings(cross, cross, true).empty()) << "asked for by name";
    }
}

TEST(CubeLayout, InvalidPixelsAreNamedByFaceAndCountedWithTheirSolidAngle) {
    const TemporaryFolder folder;
    LabelledPicture picture = labelled_picture("vertical_cross", size);
    // -Z hangs upside down under -Y: its texel (column 3, row 2) is stored 3 from the right and 2 from the bottom.
    picture.pixels[std::size_t(4 * size - 1 - 2) * picture.width + 2 * size - 1 - 3] = {1, -4, 1};
    save(folder / "a.exr", picture);
    EnvironmentSettings settings;
    settings.invalid_radiance = InvalidRadiance::reject;
    Progress progress;
    try {
        read_environment(folder / "a.exr", settings, progress);
        ADD_FAILURE() << "taken";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("the green radiance at pixel (3, 2) of face -Z is -4"),
                  std::string::npos)
            << error.what();
    }
    settings.invalid_radiance = InvalidRadiance::clamp;
    settings.exposure_stops = 1;
    settings.tint = {1, 2, 4};
    const EnvironmentMap map = read_environment(folder / "a.exr", settings, progress);
    EXPECT_EQ(map.repairs.negative_pixels, 1u);
    EXPECT_NEAR(map.repairs.energy_removed, 4 * cube_texel_solid_angles(size)[2 * size + 3], 1e-12);
    EXPECT_EQ(map.pixels[cube_texel_index(size, 5, 2, 3)], (Vec3f{2, 0, 8}));
}

TEST(CubeLayout, ByteFacesAreDecodedOnceAndWarnedOfOnce) {
    const TemporaryFolder folder;
    const std::array<const char*, 6> names{"px", "nx", "py", "ny", "pz", "nz"};
    for (int face = 0; face < cube_faces; ++face) {
        LabelledPicture picture = labelled_face(face, size);
        for (Vec3f& p : picture.pixels) p = Vec3f(128 / 255.0f);
        save(folder / (std::string(names[face]) + ".png"), picture,
             [](OIIO::ImageSpec& spec) { spec.format = OIIO::TypeDesc::UINT8; });
    }
    const EnvironmentMap map = read(folder / "{face}.png");
    EXPECT_TRUE(map.low_dynamic_range);
    EXPECT_EQ(map.warnings.size(), 1u);
    for (const Vec3f& p : map.pixels) ASSERT_NEAR(p.x, 0.215861, 1e-5);  // IEC 61966-2-1 of 128
}

}  // namespace
}  // namespace hairbake
