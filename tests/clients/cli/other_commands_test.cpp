// info, sample, compare, presets, --version and --help.
#include <gtest/gtest.h>

#include "tests/clients/cli/cli.h"

namespace hairbake::test_support {
namespace {

TEST(Program, TellsItsVersionAndItsExitCodes) {
    EXPECT_TRUE(hairbake("--version").output.starts_with("hairbake 0."));
    const Finished help = hairbake("--help");
    EXPECT_EQ(help.exit_code, 0);
    for (const char* piece : {"bake", "info", "sample", "compare", "presets", "2  usage", "5  cancelled"})
        EXPECT_TRUE(contains(help.output, piece)) << piece;
    EXPECT_TRUE(contains(hairbake("bake --help").output, "Exit codes"));
}

TEST(Program, EveryCommandsHelpHasItsOwnExitCodesOnce) {
    // 6 to 9 are of those that talk to a service.
    const auto count = [](const std::string& text, const std::string& piece) {
        std::size_t found = 0;
        for (std::size_t at = text.find(piece); at != std::string::npos; at = text.find(piece, at + 1)) ++found;
        return found;
    };
    for (const std::string local : {"bake", "info", "sample", "compare", "render", "diff", "presets", "completion"}) {
        const std::string help = hairbake(local + " --help").output;
        EXPECT_EQ(count(help, "Exit codes:"), 1u) << local;
        EXPECT_FALSE(contains(help, "6  server unreachable")) << local;
    }
    for (const std::string remote : {"submit", "status", "wait", "fetch", "cancel", "rebake", "upload"}) {
        const std::string help = hairbake(remote + " --help").output;
        EXPECT_EQ(count(help, "Exit codes:"), 1u) << remote;
        EXPECT_EQ(count(help, "6  server unreachable"), 1u) << remote;
    }
}

TEST(SampleCommand, WritesAGroomAHeadAndThreeSkies) {
    const Workshop workshop;
    for (const char* name : {"groom.hair", "head.obj", "sky.hdr", "studio.hdr", "overcast.hdr"})
        EXPECT_TRUE(std::filesystem::exists(workshop.path(std::string("samples/") + name))) << name;
}

TEST(SampleCommand, AFullDiskEndsWithFourAndLeavesNothingHalfWritten) {
    const TemporaryFolder folder;
    // No file may grow beyond 4 blocks of 512 or 1024 bytes; 3,000 vertices take 36,000 bytes.
    const Finished run = run_program("ulimit -f 4; " + shell_word(HAIRBAKE_PROGRAM) + " sample " +
                                     (folder / "").string() + " --vertices 3000 --map-width 64 2>&1");
    EXPECT_EQ(run.exit_code, 4) << run.output;
    EXPECT_TRUE(std::filesystem::is_empty(folder / ""));
}

TEST(InfoCommand, TellsTheFactsOfAModelAMapAndAResult) {
    const Workshop workshop;
    ASSERT_EQ(hairbake(workshop.quick_bake()).exit_code, 0);
    const Finished hair = hairbake("info " + workshop.path("samples/groom.hair"));
    EXPECT_TRUE(contains(hair.output, "hair model") && contains(hair.output, "3000")) << hair.output;
    EXPECT_TRUE(contains(hairbake("info " + workshop.path("samples/sky.hdr")).output, "environment map"));
    EXPECT_TRUE(contains(hairbake("info " + workshop.path("out")).output, "bake result"));
    const auto json = nlohmann::json::parse(hairbake("info --json " + workshop.path("out")).output);
    EXPECT_EQ(json["kind"], "bake result");
    EXPECT_EQ(hairbake("info " + workshop.path("missing") + " 2>&1").exit_code, 3);
}

TEST(InfoCommand, AHostileManifestIsBadInput) {
    const TemporaryFolder folder;
    std::ofstream(folder / "manifest.json") << R"({"format": "hairbake result", "files": [], "warnings": )"
                                            << std::string(500'000, '[') << std::string(500'000, ']') << "}";
    const Finished run = hairbake("info " + (folder / "").string() + " 2>&1");
    EXPECT_EQ(run.exit_code, 3) << run.output;
    EXPECT_TRUE(contains(run.output, "manifest.json is nested deeper than 64 levels")) << run.output;
    EXPECT_EQ(
        hairbake("render " + (folder / "").string() + " --out " + (folder / "a.png").string() + " 2>&1").exit_code, 3);
}

TEST(CompareCommand, GivesDifferencesAsATableAndAsJson) {
    const Workshop workshop;
    ASSERT_EQ(hairbake(workshop.quick_bake()).exit_code, 0);
    ASSERT_EQ(hairbake("bake" + workshop.hair() + workshop.env() + workshop.out("other") +
                       " --directions 9 --voxels 32 --face-size 4 --specular-maps 3")
                  .exit_code,
              0);
    const std::string two = workshop.path("out") + " " + workshop.path("other");
    const auto report = nlohmann::json::parse(hairbake("compare --json " + two).output);
    EXPECT_EQ(report["same"], false);
    EXPECT_GT(report["transmittance"]["max_abs"], 0);
    EXPECT_EQ(report["diffuse"]["max_abs"], 0);  // the lighting is the same
    EXPECT_EQ(report["equal"], false);
    const Finished table = hairbake("compare " + two);
    EXPECT_TRUE(table.output.starts_with("different: ")) << table.output;
    EXPECT_TRUE(contains(table.output, "specular_02"));
    EXPECT_EQ(table.exit_code, 1);
    EXPECT_EQ(hairbake("compare --json " + two).exit_code, 1);
}

// Relatives: the same folder, a tolerance that is too small, JSON, errors of every kind.
TEST(CompareCommand, ItsExitCodeIsItsVerdict) {
    const Workshop workshop;
    ASSERT_EQ(hairbake(workshop.quick_bake()).exit_code, 0);
    ASSERT_EQ(hairbake("bake" + workshop.hair() + workshop.env() + workshop.out("other") +
                       " --directions 9 --voxels 32 --face-size 4 --specular-maps 3")
                  .exit_code,
              0);
    const std::string out = workshop.path("out"), two = out + " " + workshop.path("other");
    const Finished itself = hairbake("compare " + out + " " + out);
    EXPECT_EQ(itself.exit_code, 0);
    EXPECT_TRUE(itself.output.starts_with("equal: ")) << itself.output;
    const Finished within = hairbake("compare --tolerance 1 " + two);
    EXPECT_EQ(within.exit_code, 0);
    EXPECT_TRUE(within.output.starts_with("equal (tolerance 1): ")) << within.output;
    EXPECT_EQ(hairbake("compare --tolerance 1e-6 " + two).exit_code, 1);
    const auto report = nlohmann::json::parse(hairbake("compare --json --tolerance 1 " + two).output);
    EXPECT_EQ(report["equal"], true);
    EXPECT_EQ(report["same"], false);
    for (const std::string& wrong : {out + " /no/such", out, out + " " + workshop.path("samples"),
                                     "--tolerance 2 " + two, "--tolerance x " + two, two + " --surprise"})
        EXPECT_EQ(hairbake("compare " + wrong + " 2>&1").exit_code, 2) << wrong;
    EXPECT_TRUE(contains(hairbake("compare " + out + " /no/such 2>&1").output, "/no/such"));
}

TEST(InfoCommand, TellsTheFactsOfAMeshAndTheWidthsOfHair) {
    const Workshop workshop;
    const Finished mesh = hairbake("info " + workshop.path("samples/head.obj"));
    for (const char* piece : {"mesh", "OBJ", "36480", "closed"})
        EXPECT_TRUE(contains(mesh.output, piece)) << mesh.output;
    const Finished hair = hairbake("info " + workshop.path("samples/groom.hair"));
    for (const char* piece : {"thickness.minimum", "thickness.mean", "thickness.maximum"})
        EXPECT_TRUE(contains(hair.output, piece)) << hair.output;
}

// Relative: an input that was named by an absolute path.
TEST(BakeCommand, AResultRemembersItsInputsByDigestAndPath) {
    const Workshop workshop;
    ASSERT_EQ(run_program("cd " + workshop.path("samples") + " && " + shell_word(HAIRBAKE_PROGRAM) +
                          " bake --hair groom.hair" + workshop.env() + workshop.out() +
                          " --directions 16 --voxels 32 --face-size 4 --specular-maps 3 --outputs npy 2>&1")
                  .exit_code,
              0);
    const nlohmann::json inputs = json_of(workshop.path("out/manifest.json"))["inputs"];
    EXPECT_EQ(inputs["hair"]["path"], "groom.hair");
    EXPECT_EQ(inputs["hair"]["absolute_path"], workshop.path("samples/groom.hair"));
    EXPECT_EQ(inputs["environment"]["path"], workshop.path("samples/sky.hdr"));
    EXPECT_EQ(inputs["environment"]["absolute_path"], workshop.path("samples/sky.hdr"));
    EXPECT_EQ(inputs["hair"]["sha256"].get<std::string>().size(), 64u);
    // `render` finds them from another folder, and says where it sought those that have gone.
    const std::string render = "cd / && " + shell_word(HAIRBAKE_PROGRAM) + " render " + workshop.path("out") +
                               " --size 8x8 --samples 1 --out " + workshop.path("a.png") + " 2>&1";
    EXPECT_EQ(run_program(render).exit_code, 0) << run_program(render).output;
    std::filesystem::rename(workshop.path("samples/groom.hair"), workshop.path("samples/moved.hair"));
    const Finished lost = run_program(render);
    EXPECT_EQ(lost.exit_code, 2);
    EXPECT_TRUE(contains(lost.output, "sought was groom.hair and " + workshop.path("samples/groom.hair") + " (from /)"))
        << lost.output;
    EXPECT_TRUE(contains(lost.output, "--hair"));
    std::filesystem::rename(workshop.path("samples/moved.hair"), workshop.path("samples/groom.hair"));
    std::filesystem::remove(workshop.path("samples/sky.hdr"));
    EXPECT_TRUE(contains(run_program(render).output, "sought was " + workshop.path("samples/sky.hdr"))) << lost.output;
}

TEST(PresetsCommand, ListsPresetsShowsOneAndPrintsTheSchema) {
    const Finished list = hairbake("presets");
    for (const char* name : {"draft", "final", "paper"}) EXPECT_TRUE(contains(list.output, name)) << name;
    EXPECT_EQ(nlohmann::json::parse(hairbake("presets paper").output)["irradiance"]["specular_maps"], 9);
    EXPECT_EQ(nlohmann::json::parse(hairbake("presets --schema").output)["title"], "hairbake request");
}

TEST(ShippedPresets, NeedNoFilesBesideTheProgram) {
    const TemporaryFolder folder;
    const Finished run = run_program("cp " + shell_word(HAIRBAKE_PROGRAM) + " " + (folder / "copy").string() +
                                     " && cd / && " + (folder / "copy").string() + " presets draft");
    EXPECT_EQ(run.exit_code, 0) << run.output;
}

}  // namespace
}  // namespace hairbake::test_support
