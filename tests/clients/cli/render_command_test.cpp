// render and diff.
#include <gtest/gtest.h>

#include "tests/clients/cli/cli.h"

namespace hairbake::test_support {
namespace {

TEST(RenderCommand, ShowsAResultInEveryModeAndDiffComparesThem) {
    const Workshop workshop;
    ASSERT_EQ(hairbake(workshop.quick_bake()).exit_code, 0);
    const std::string small = " --size 32x24 --samples 2 --exposure 0";
    for (const char* mode : {"baked", "brute", "reference"}) {
        const Finished run =
            hairbake("render " + workshop.path("out") + " --mesh " + workshop.path("samples/head.obj") + " --out " +
                     workshop.path(std::string(mode) + ".exr") + " --out " + workshop.path(std::string(mode) + ".png") +
                     " --mode " + mode + small + " 2>&1");
        EXPECT_EQ(run.exit_code, 0) << run.output;
        EXPECT_TRUE(contains(run.output, "32 x 24 pixels")) << run.output;
    }
    const std::string two = workshop.path("brute.exr") + " " + workshop.path("reference.exr");
    const auto report = nlohmann::json::parse(hairbake("diff --json " + two).output);
    EXPECT_GT(report["rmse"], 0);
    EXPECT_EQ(report["height"], 24);
    EXPECT_TRUE(contains(hairbake("diff " + two + " --out " + workshop.path("d.png")).output, "RMSE"));
    // The folder may stand behind the files, as the usage line has it.
    const Finished behind = hairbake("render --out " + workshop.path("e.exr") + " " + workshop.path("out") + small);
    EXPECT_EQ(behind.exit_code, 0) << behind.output;
    EXPECT_TRUE(std::filesystem::exists(workshop.path("d.png")));
}

TEST(RenderCommand, BakesInMemoryAndTellsItsProgress) {
    const Workshop workshop;
    const Finished run = hairbake("render" + workshop.hair() + workshop.env() + " --out " + workshop.path("a.exr") +
                                  " --size 24x24 --samples 1 --set transmittance.voxels=32 --progress json");
    EXPECT_EQ(run.exit_code, 0);
    EXPECT_TRUE(contains(run.output, "\"phase\":\"render\"")) << run.output;
    EXPECT_TRUE(contains(run.output, "\"event\":\"done\""));
}

TEST(RenderCommand, ShowsTransmittanceAndTangentsOfABakeWithoutLight) {
    // Neither depends on the light: the pictures are those of a bake with an environment, pixel by pixel.
    const Workshop workshop;
    const std::string thick = " --set strand.width_scale=20";  // so that the few strands fill some of the picture
    ASSERT_EQ(hairbake(workshop.quick_bake() + thick).exit_code, 0);
    ASSERT_EQ(hairbake("bake" + workshop.hair() + thick + workshop.out("dark") +
                       " --directions 16 --voxels 32 --set transmittance.reference_vertices=0")
                  .exit_code,
              0);
    const auto show = [&](const std::string& what, const std::string& channel, const std::string& file) {
        return hairbake("render " + what + " --channel " + channel + " --mesh " + workshop.path("samples/head.obj") +
                        " --out " + workshop.path(file) + " --size 32x24 --samples 2 2>&1");
    };
    for (const std::string channel : {"transmittance", "tangent"}) {
        ASSERT_EQ(show(workshop.path("out") + workshop.env(), channel, "lit.exr").exit_code, 0);
        const Finished run = show(workshop.path("dark"), channel, "dark.exr");
        ASSERT_EQ(run.exit_code, 0) << run.output;
        const auto report = nlohmann::json::parse(
            hairbake("diff --json " + workshop.path("lit.exr") + " " + workshop.path("dark.exr")).output);
        EXPECT_EQ(report["max_abs"], 0);
        EXPECT_GT(report["lit"]["pixels"], 32 * 24 / 20);  // a picture of something
    }
    // Baked in memory, no environment has to be named either; where light is shown, it has to.
    EXPECT_EQ(show(workshop.hair() + " --set transmittance.voxels=32", "tangent", "memory.exr").exit_code, 0);
    const Finished beauty = show(workshop.path("dark"), "beauty", "beauty.exr");
    EXPECT_EQ(beauty.exit_code, 2);
    EXPECT_TRUE(contains(beauty.output, "give the file (--env)")) << beauty.output;
    EXPECT_EQ(show(workshop.path("dark"), "diffuse", "diffuse.exr").exit_code, 2);
}

TEST(RenderCommand, LeavesNothingWhereThePictureCannotBeWritten) {
    // The name is a folder's: the picture is written whole under another name, and cannot take this one.
    const Workshop workshop;
    std::filesystem::create_directories(workshop.path("pictures/taken.png/inside"));
    const Finished run =
        hairbake("render" + workshop.hair() + " --channel tangent --size 8x8 --samples 1" +
                 " --set transmittance.voxels=16 --out " + workshop.path("pictures/taken.png") + " 2>&1");
    EXPECT_NE(run.exit_code, 0);
    for (const auto& entry : std::filesystem::directory_iterator(workshop.path("pictures")))
        EXPECT_EQ(entry.path().filename(), "taken.png");
}

TEST(RenderCommand, RefusesWhatItCannotDo) {
    const Workshop workshop;
    const std::string out = " --out " + workshop.path("a.png");
    EXPECT_EQ(hairbake("render" + out + " 2>&1").exit_code, 2);
    EXPECT_EQ(hairbake("render /no/such" + out + " 2>&1").exit_code, 3);
    EXPECT_EQ(hairbake("render" + workshop.hair() + workshop.env() + out + " --mode magic 2>&1").exit_code, 2);
    EXPECT_EQ(hairbake("render" + workshop.hair() + workshop.env() + out + " --size 0x5 2>&1").exit_code, 2);
    EXPECT_EQ(hairbake("render" + workshop.hair() + workshop.env() + out + " --size big 2>&1").exit_code, 2);
    EXPECT_EQ(hairbake("diff /no/such.exr /no/such.exr 2>&1").exit_code, 3);
    EXPECT_FALSE(std::filesystem::exists(workshop.path("a.png")));
}

// Relative: a mesh without anything to tell.
TEST(RenderCommand, WarningsOfItsMeshArePrinted) {
    const Workshop workshop;
    ASSERT_EQ(hairbake(workshop.quick_bake()).exit_code, 0);
    std::ofstream(workshop.path("bow.obj")) << "v 0 0 0\nv 9 9 0\nv 9 0 0\nv 0 9 0\nf 1 2 3 4\n";
    const std::string render =
        "render " + workshop.path("out") + " --size 8x8 --samples 1 --out " + workshop.path("a.png");
    const Finished bow = hairbake(render + " --mesh " + workshop.path("bow.obj") + " 2>&1");
    EXPECT_EQ(bow.exit_code, 0);
    EXPECT_TRUE(
        contains(bow.output, "warning: the mesh: in 1 of its 1 face the outline crosses itself, first in face 1"))
        << bow.output;
    EXPECT_FALSE(
        contains(hairbake(render + " --mesh " + workshop.path("samples/head.obj") + " 2>&1").output, "the mesh"));
}

}  // namespace
}  // namespace hairbake::test_support
