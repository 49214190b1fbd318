#include <gtest/gtest.h>

#include <sstream>

#include "tests/clients/cli/cli.h"

namespace hairbake::test_support {
namespace {

TEST(BakeCommand, BakesAndSaysInOneLineWhereTheResultsAre) {
    const Workshop workshop;
    const Finished run = hairbake(workshop.quick_bake());
    EXPECT_EQ(run.exit_code, 0) << run.output;
    EXPECT_TRUE(run.output.starts_with(workshop.path("out") + ": transmittance of 3000 vertices")) << run.output;
    EXPECT_EQ(std::count(run.output.begin(), run.output.end(), '\n'), 1);
    EXPECT_TRUE(std::filesystem::exists(workshop.path("out/manifest.json")));
}

TEST(BakeCommand, HairAloneAndEnvironmentAloneBakeTheirStageOnly) {
    const Workshop workshop;
    EXPECT_EQ(hairbake("bake" + workshop.hair() + workshop.out("h") + " --preset draft").exit_code, 0);
    EXPECT_EQ(hairbake("bake" + workshop.env() + workshop.out("e") + " --preset draft").exit_code, 0);
    EXPECT_TRUE(std::filesystem::exists(workshop.path("h/transmittance.npy")));
    EXPECT_FALSE(std::filesystem::exists(workshop.path("h/diffuse.npy")));
    EXPECT_TRUE(std::filesystem::exists(workshop.path("e/diffuse.npy")));
    EXPECT_FALSE(std::filesystem::exists(workshop.path("e/transmittance.npy")));
}

TEST(BakeCommand, LaterWinsPresetThenRequestFileThenFlagsThenSet) {
    const Workshop workshop;
    std::ofstream(workshop.path("request.json"))
        << R"({"transmittance": {"directions": 9, "voxels": 40, "reference_vertices": 3}, "outputs": ["npy"]})";
    const Finished run = hairbake("bake" + workshop.hair() + workshop.out() + " --preset paper --request " +
                                  workshop.path("request.json") + " --voxels 48 --width 0.02 --opacity from_file" +
                                  " --set transmittance.reference_vertices=5 --set irradiance.sh_bands.diffuse=auto");
    ASSERT_EQ(run.exit_code, 0) << run.output;
    const auto request = json_of(workshop.path("out/manifest.json"))["request"];
    EXPECT_EQ(request["transmittance"]["direction_set"], "random");   // the preset's
    EXPECT_EQ(request["transmittance"]["directions"], 9);             // the file's, over the preset's 100
    EXPECT_EQ(request["transmittance"]["voxels"], 48);                // the flag's, over the file's 40
    EXPECT_EQ(request["transmittance"]["reference_vertices"], 5);     // --set's, over the file's 3
    EXPECT_EQ(request["irradiance"]["sh_bands"]["diffuse"], "auto");  // --set's, over the preset's 3
    EXPECT_EQ(request["irradiance"]["sh_bands"]["specular"], 8);      // the preset's
    EXPECT_EQ(request["strand"]["width"], 0.02);
    EXPECT_EQ(request["strand"]["opacity"], "from_file");
    EXPECT_EQ(request["outputs"], nlohmann::json({"npy"}));
}

TEST(BakeCommand, TakesSixFacesAsAFolderOrAPatternAndLights) {
    // Faces of one colour each, written as PFM by hand: the brightest is +Y.
    const Workshop workshop;
    std::filesystem::create_directory(workshop.path("sky"));
    for (const std::string face : {"px", "nx", "py", "ny", "pz", "nz"}) {
        const std::vector<float> values(3 * 2 * 2, face == "py" ? 5.0f : 1.0f);
        std::ofstream file(workshop.path("sky/day_" + face + ".pfm"), std::ios::binary);
        file << "PF\n2 2\n-1.0\n";
        file.write(reinterpret_cast<const char*>(values.data()), std::streamsize(values.size() * sizeof(float)));
    }
    const std::string light = R"( --set 'irradiance.lights=[{"direction": [0, 1, 0], "irradiance": [1, 2, 3]}]')";
    const std::string quick = " --face-size 4 --specular-maps 3";
    const Finished one = hairbake("bake --env " + workshop.path("sky") + workshop.out("a") + quick + light);
    ASSERT_EQ(one.exit_code, 0) << one.output;
    const Finished two = hairbake("bake --env '" + workshop.path("sky/day_{face}.pfm") + "' --layout faces" +
                                  workshop.out("b") + quick + light);
    ASSERT_EQ(two.exit_code, 0) << two.output;
    const auto a = json_of(workshop.path("a/manifest.json")), b = json_of(workshop.path("b/manifest.json"));
    EXPECT_EQ(a["inputs"]["environment"]["layout"], "faces");
    EXPECT_EQ(a["inputs"]["environment"]["face_size"], 2);
    EXPECT_EQ(a["inputs"]["environment"]["sha256"], b["inputs"]["environment"]["sha256"]);
    EXPECT_EQ(a["irradiance"], b["irradiance"]);
    EXPECT_EQ(a["request"]["irradiance"]["lights"][0]["irradiance"], nlohmann::json({1.0, 2.0, 3.0}));

    const auto facts = nlohmann::json::parse(hairbake("info --json " + workshop.path("sky")).output);
    EXPECT_EQ(facts["layout"], "faces");
    EXPECT_EQ(facts["brightest_pixel"]["face"], "+Y");
    const Finished missing =
        hairbake("bake --env '" + workshop.path("sky/night_{face}.pfm") + "'" + workshop.out("c") + " 2>&1");
    EXPECT_EQ(missing.exit_code, 3);
    EXPECT_TRUE(contains(missing.output, "no faces of a cube map")) << missing.output;
}

TEST(BakeCommand, ShBandsSetsBothKindsOfMap) {
    const Workshop workshop;
    ASSERT_EQ(hairbake("bake" + workshop.env() + workshop.out() +
                       " --preset draft --method sh --sh-bands 6 --exponent 5 --outputs npy,exr")
                  .exit_code,
              0);
    const auto manifest = json_of(workshop.path("out/manifest.json"));
    EXPECT_EQ(manifest["request"]["irradiance"]["sh_bands"], nlohmann::json({{"diffuse", 6}, {"specular", 6}}));
    EXPECT_EQ(manifest["irradiance"]["sh_bands"], nlohmann::json({{"diffuse", 6}, {"specular", 6}}));
    EXPECT_EQ(manifest["request"]["outputs"], nlohmann::json({"npy", "exr"}));
}

TEST(BakeCommand, ShBandsWithoutTheMethodThatReadsThemIsWarnedOf) {
    const Workshop workshop;
    const std::string bake = "bake" + workshop.env() + workshop.out() + " --face-size 4 --specular-maps 3 --exponent 5";
    const auto warned = [&](const std::string& flags) {
        const Finished run = hairbake(bake + flags + " 2>&1");
        EXPECT_EQ(run.exit_code, 0) << run.output;
        return contains(run.output, "--sh-bands is not used");
    };
    EXPECT_TRUE(warned(" --sh-bands 6"));
    EXPECT_TRUE(warned(" --sh-bands 6 --method sh --set irradiance.method=exact"));  // later wins
    EXPECT_FALSE(warned(" --sh-bands 6 --method sh"));
    EXPECT_FALSE(warned(" --sh-bands 6 --set irradiance.method=sh"));
    EXPECT_FALSE(warned(""));
}

TEST(BakeCommand, DeepNestingInARequestFileOrAFlagIsAUsageError) {
    const Workshop workshop;
    const auto lists = [](int levels) { return std::string(levels, '[') + std::string(levels, ']'); };
    std::ofstream(workshop.path("deep.json")) << lists(500'000);
    // The longest argument that Linux passes on is 128 KiB.
    for (const std::string& flags :
         {" --request " + workshop.path("deep.json"), " --set 'outputs=" + lists(60'000) + "'"}) {
        const Finished run = hairbake("bake" + workshop.hair() + workshop.out() + flags + " 2>&1");
        EXPECT_EQ(run.exit_code, 2) << run.output;
        EXPECT_TRUE(contains(run.output, "nested deeper than 64 levels")) << run.output;
    }
}

TEST(BakeCommand, TraceIsReachedByItsPath) {
    const Workshop workshop;
    const Finished run =
        hairbake("bake" + workshop.hair() + workshop.out() + " --preset draft --set transmittance.method=trace");
    ASSERT_EQ(run.exit_code, 0) << run.output;
    EXPECT_EQ(json_of(workshop.path("out/manifest.json"))["transmittance"]["voxel_size"], 0);
}

TEST(BakeCommand, UsageErrorsEndWithTwoAndNameTheFieldAndWhatIsAllowed) {
    const Workshop workshop;
    const std::string both = "bake" + workshop.hair() + workshop.out();
    const std::tuple<std::string, std::string> cases[] = {
        {"", "no command is given"},
        {"bake", "--out"},
        {"bake" + workshop.out(), "--hair"},
        {both + " --no-such-flag", "--no-such-flag"},
        {both + " --voxels 7", "32 to 1024"},
        {both + " --voxels many", "transmittance.voxels"},
        {both + " --set transmittance.voxel=7", "voxels"},
        {both + " --set nonsense", "path=value"},
        {both + " --preset best", "draft, final, paper"},
        {both + " --threads -1", "--threads"},
        {both + " --progress loud", "--progress"},
        {both + " --outputs npy,obj", "npy, exr, hair, ktx2, dds, raw, glb, vdb"},
        {"sample " + workshop.path("s") + " --paper-model 5", "--paper-model"},
        {"presets best", "draft, final, paper"},
    };
    for (const auto& [arguments, piece] : cases) {
        const Finished run = hairbake(arguments + " 2>&1");
        EXPECT_EQ(run.exit_code, 2) << arguments << "\n" << run.output;
        EXPECT_TRUE(contains(run.output, piece)) << arguments << "\n" << run.output;
    }
    EXPECT_EQ(workshop.names(), std::vector<std::string>{"samples"});
}

TEST(BakeCommand, AForeignFolderIsRefusedBeforeAnythingIsBaked) {
    const Workshop workshop;
    std::filesystem::create_directory(workshop.path("out"));
    std::ofstream(workshop.path("out/thesis.txt")) << "precious";
    const Finished run = hairbake("bake --hair /no/such/file" + workshop.out() + " 2>&1");
    EXPECT_EQ(run.exit_code, 2) << run.output;
    EXPECT_TRUE(contains(run.output, "manifest.json")) << run.output;
}

TEST(BakeCommand, BadInputEndsWithThreeAndNamesTheFile) {
    const Workshop workshop;
    std::ofstream(workshop.path("broken.hair")) << "HAIR, but no more";
    for (const std::string name : {"missing.hair", "broken.hair"}) {
        const Finished run = hairbake("bake --hair " + workshop.path(name) + workshop.out() + " 2>&1");
        EXPECT_EQ(run.exit_code, 3) << run.output;
        EXPECT_TRUE(contains(run.output, name)) << run.output;
    }
    EXPECT_EQ(hairbake("bake" + workshop.hair() + workshop.out() + " --request /no/such.json 2>&1").exit_code, 3);
    EXPECT_EQ(workshop.names(), (std::vector<std::string>{"broken.hair", "samples"}));
}

TEST(BakeCommand, AFullDiskEndsWithFourAndLeavesNothing) {
    const Workshop workshop;
    // No file may grow beyond 4 blocks of 512 or 1024 bytes: as a full disk, the write fails.
    const Finished run =
        run_program("ulimit -f 4; " + shell_word(HAIRBAKE_PROGRAM) + " " + workshop.quick_bake() + " 2>&1");
    EXPECT_EQ(run.exit_code, 4) << run.output;
    EXPECT_TRUE(contains(run.output, "cannot be written")) << run.output;
    EXPECT_EQ(workshop.names(), std::vector<std::string>{"samples"});
}

TEST(BakeCommand, ProgressJsonIsOneObjectALineFromNothingToDone) {
    const Workshop workshop;
    const Finished run = hairbake(workshop.quick_bake() + " --progress json");
    ASSERT_EQ(run.exit_code, 0) << run.output;
    std::istringstream lines(run.output);
    double fraction = 0;
    nlohmann::json last;
    std::set<std::string> phases;
    for (std::string line; std::getline(lines, line);) {
        last = nlohmann::json::parse(line);
        if (last["event"] != "progress") break;
        EXPECT_GE(last["fraction"], fraction);
        EXPECT_LE(last["fraction"], 1);
        fraction = last["fraction"];
        phases.insert(last["phase"].get<std::string>());
    }
    EXPECT_EQ(last["event"], "done");
    EXPECT_EQ(last["folder"], workshop.path("out"));
    EXPECT_EQ(fraction, 1);
    EXPECT_EQ(phases, (std::set<std::string>{"read_hair", "transmittance", "reference", "read_environment",
                                             "irradiance", "write"}));
}

TEST(BakeCommand, ProgressJsonTellsOfFailuresToo) {
    const Workshop workshop;
    const Finished run =
        hairbake("bake" + workshop.hair() + workshop.out() + " --progress json --voxels 7 2>/dev/null");
    EXPECT_EQ(run.exit_code, 2);
    const auto event = nlohmann::json::parse(run.output);
    EXPECT_EQ(event["event"], "error");
    EXPECT_EQ(event["kind"], "usage");
    EXPECT_EQ(event["field"], "transmittance.voxels");
}

}  // namespace
}  // namespace hairbake::test_support
