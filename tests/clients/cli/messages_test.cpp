// Messages, help and habits: what people type, and what they are told.
#include <gtest/gtest.h>

#include "tests/clients/cli/cli.h"

namespace hairbake::test_support {
namespace {

std::string told(const std::string& arguments, int exit_code = 2) {
    const Finished run = hairbake(arguments + " 2>&1");
    EXPECT_EQ(run.exit_code, exit_code) << arguments << "\n" << run.output;
    return run.output;
}

TEST(Messages, ShowNothingOfTheOptionParser) {
    const Workshop workshop;
    const std::string render = "render " + workshop.path("none") + " --out " + workshop.path("a.png");
    const std::pair<std::string, std::string> cases[] = {
        {render + " --mode magic", "--mode is magic; allowed is one of baked, brute, reference, directional"},
        // Relatives: every kind of check of the parser.
        {render + " --channel alpha", "--channel is alpha; allowed is one of beauty, transmittance"},
        {render + " --samples 1.5", "--samples is 1.5; allowed is a whole number from 1 to 65536"},
        {render + " --samples many", "--samples is many; allowed is a whole number"},
        {render + " --light-samples 0", "--light-samples is 0; allowed is a whole number from 1 to 65536"},
        {render + " --fov 180", "--fov is 180; allowed is 1 to 150"},
        {render + " --color 1,2", "--color is 1,2; allowed are three numbers"},
        {render + " --color 1,1,1.5", "each 0 to 1"},
        {render + " --target 0,0,x", "--target is 0,0,x; allowed are three numbers"},
        {render + " --distance far", "--distance is far; allowed is a number"},
        {"bake --threads 5000 --out a", "--threads is 5000; allowed is a whole number from 0 to 1024"},
        {"bake --progress loud --out a", "--progress is loud; allowed is one of auto, json, none"},
        {"bake --out", "--out needs a value"},
        {"bake --out a --out b", "--out is given 2 times; allowed is once"},
        {"sample a --paper-model 2 --style wavy", "--style and --paper-model are given; allowed is one of them"},
        {"bake --hair a", "--out is required"},
        {"status --state lost --server http://a", "--state is lost; allowed is one of queued"},
        {"submit --hair a --priority 11 --server http://a",
         "--priority is 11; allowed is a whole number from -10 to 10"},
        {"wait --patience -1 --server http://a", "--patience is -1; allowed is 0 to 86400"},
    };
    for (const auto& [arguments, piece] : cases) {
        const std::string text = told(arguments);
        EXPECT_TRUE(contains(text, piece)) << arguments << "\n" << text;
        for (const char* inside :
             {"FAILED", "Check ", "{", "INT", "TEXT", "FLOAT", "not in range", "Could not convert"})
            EXPECT_FALSE(contains(text, inside)) << text;
    }
}

TEST(Messages, NameUnknownOptionsAndCommandsAsTypedWithTheOneThatWasMeant) {
    const Workshop workshop;
    const std::string bake = "bake" + workshop.hair() + workshop.out();
    EXPECT_TRUE(contains(told(bake + " --voxel 64"), "bake has no option --voxel (did you mean --voxels?)"));
    // Relatives.
    EXPECT_TRUE(contains(told(bake + " --voxel=64"), "no option --voxel=64 (did you mean --voxels?)"));
    EXPECT_TRUE(
        contains(told("bake --haire a --voxels 3"), "no option --haire (did you mean --hair?)"));  // --out lacks too
    EXPECT_TRUE(contains(told("render --siez 64x64 --out a.png dir"), "no option --siez (did you mean --size?)"));
    EXPECT_TRUE(contains(told(bake + " --wait"), "--wait; it is an option of submit, rebake"));
    EXPECT_TRUE(contains(told(bake + " --no-such-flag"), "--no-such-flag"));
    EXPECT_TRUE(contains(told("bake -hair a --out b"), "bake has no option -hair (did you mean --hair?)"));
    EXPECT_TRUE(contains(told(bake + " --set =3"), "--set =3 is not of the form path=value"));
    EXPECT_TRUE(contains(told(bake + " extra"), "bake takes no argument extra"));
    EXPECT_TRUE(contains(told("bak --out a"), "there is no command bak (did you mean bake?)") ||
                contains(told("bak --out a"), "there is no option --out"));
    EXPECT_TRUE(contains(told("bak"), "there is no command bak (did you mean bake?)"));
    EXPECT_TRUE(contains(told("--verson"), "there is no option --verson (did you mean --version?)"));
    EXPECT_TRUE(contains(told(bake + " --set voxels=64"), "did you mean transmittance.voxels?"));
    EXPECT_TRUE(contains(told(bake + " --set transmitance.seed=2"), "did you mean transmittance.seed?"));
}

TEST(Messages, NameTheFlagThatGaveAFieldAndPathsAsTyped) {
    const Workshop workshop;
    const std::string bake = "bake" + workshop.hair() + workshop.out();
    EXPECT_TRUE(contains(told(bake + " --voxels 7"), "--voxels: transmittance.voxels is 7; allowed is 32 to 1024"));
    EXPECT_TRUE(contains(told(bake + " --rotation 90"), "--rotation: environment_settings.rotation_deg"));
    EXPECT_TRUE(contains(told(bake + " --set transmittance.seed=9007199254740992"),
                         "is 9007199254740992; allowed is 0 to 9007199254740991"));
    const std::string line = "cd " + workshop.path("") + " && " + shell_word(HAIRBAKE_PROGRAM) +
                             " bake --hair ./samples/../samples/groom.hair --out samples/head.obj/./x 2>&1";
    const std::string text = run_program(line).output;
    EXPECT_TRUE(contains(text, "samples/head.obj/./x cannot be written: Not a directory")) << text;
    EXPECT_FALSE(contains(text, "filesystem error") || contains(text, workshop.path("samples"))) << text;
    EXPECT_TRUE(
        contains(told("bake" + workshop.hair() + " --out ''"), "out is empty; allowed is the path of a folder"));
    EXPECT_TRUE(contains(told(bake + " --request " + workshop.path("samples"), 3), "samples: Is a directory"));
    EXPECT_TRUE(contains(told(bake + " --transmittance-method volume --set transmittance.voxel_size=1e-9"),
                         "transmittance.voxel_size is 1e-09, which"));
    std::ofstream(workshop.path("broken.json")) << "{";
    EXPECT_FALSE(contains(told(bake + " --request " + workshop.path("broken.json")), "json.exception"));
}

TEST(Messages, AFullDiskNamesTheResultAndNotItsHiddenFolder) {
    const Workshop workshop;
    const Finished run =
        run_program("ulimit -f 4; " + shell_word(HAIRBAKE_PROGRAM) + " " + workshop.quick_bake() + " 2>&1");
    EXPECT_TRUE(contains(run.output, workshop.path("out/"))) << run.output;
    EXPECT_FALSE(contains(run.output, ".hairbake-")) << run.output;
    const Finished picture =
        run_program("ulimit -f 0; " + shell_word(HAIRBAKE_PROGRAM) + " render" + workshop.hair() +
                    " --channel tangent --size 8x8 --samples 1 --out " + workshop.path("a.exr") + " 2>&1");
    EXPECT_EQ(picture.exit_code, 4) << picture.output;
    EXPECT_FALSE(contains(picture.output, ".part-")) << picture.output;
}

TEST(Numbers, MayBeWrittenAsPeopleDo) {
    const Workshop workshop;
    ASSERT_EQ(hairbake("bake" + workshop.hair() + workshop.env() + workshop.out() +
                       " --width .05 --voxels +40 --directions 9. --rotation .5,+90,0. --exposure +1 --face-size 4" +
                       " --specular-maps 3 --set irradiance.sh_error=.5e-1 --set transmittance.reference_vertices=+0" +
                       " --threads +1")
                  .exit_code,
              0);
    const auto request = json_of(workshop.path("out/manifest.json"))["request"];
    EXPECT_EQ(request["strand"]["width"], 0.05);
    EXPECT_EQ(request["transmittance"]["voxels"], 40);
    EXPECT_EQ(request["transmittance"]["directions"], 9);
    EXPECT_EQ(request["environment_settings"]["rotation_deg"], nlohmann::json({0.5, 90.0, 0.0}));
    EXPECT_EQ(request["environment_settings"]["exposure_stops"], 1);
    EXPECT_EQ(request["irradiance"]["sh_error"], 0.05);
    const Finished picture = hairbake(
        "render " + workshop.path("out") + workshop.env() + " --size 8x8 --samples +1 --exposure .5 --fov 30." +
        " --color .5,+1,0. --target +0,.1,0. --azimuth -.5 --out " + workshop.path("a.png") + " 2>&1");
    EXPECT_EQ(picture.exit_code, 0) << picture.output;
}

TEST(Flags, OfRotationExposureLatlongInvalidRadianceAndMethodSetTheirFields) {
    const Workshop workshop;
    ASSERT_EQ(hairbake("bake" + workshop.hair() + workshop.env() + workshop.out() +
                       " --preset draft --rotation 0,45,0 --exposure -1 --latlong filament --invalid-radiance reject" +
                       " --transmittance-method trace --directions 4")
                  .exit_code,
              0);
    const auto request = json_of(workshop.path("out/manifest.json"))["request"];
    EXPECT_EQ(request["environment_settings"]["rotation_deg"], nlohmann::json({0, 45, 0}));
    EXPECT_EQ(request["environment_settings"]["exposure_stops"], -1);
    EXPECT_EQ(request["environment_settings"]["latlong"], "filament");
    EXPECT_EQ(request["environment_settings"]["invalid_radiance"], "reject");
    EXPECT_EQ(request["transmittance"]["method"], "trace");
}

TEST(SilentChoices, AreSentences) {
    const Workshop workshop;
    const std::string maps = "bake" + workshop.env() + workshop.out() + " --face-size 4 --specular-maps 3";
    const std::string hair = "bake" + workshop.hair() + workshop.out() + " --preset draft";
    const std::pair<std::string, std::string> cases[] = {
        {maps + " --directions 5", "--directions is not used: there is no hair"},
        {maps + " --outputs npy,glb", "no file of the output glb is written"},
        {hair + " --voxels 32 --set transmittance.voxel_size=.1", "transmittance.voxels is not used"},
        {hair + " --threads 1000", "--threads is 1000, but this process has"},
        // Relatives.
        {maps + " --set strand.width=1", "--set strand.width=1 is not used: there is no hair"},
        {hair + " --layout latlong", "--layout is not used: there is no environment"},
        {hair + " --outputs npy,exr", "no file of the output exr is written"},
        {hair + " --transmittance-method trace --voxels 64",
         "--voxels is not used: transmittance.method needs no voxels"},
        {hair + " --set transmittance.opacity_maps.layers=2", "transmittance.opacity_maps.layers=2 is not used"},
        {"render" + workshop.hair() + " --channel tangent --size 8x8 --samples 1 --threads 1000 --out " +
             workshop.path("a.png"),
         "--threads is 1000"},
    };
    for (const auto& [arguments, piece] : cases) {
        const std::string text = told(arguments, 0);
        EXPECT_TRUE(contains(text, piece)) << arguments << "\n" << text;
        EXPECT_EQ(text.find(piece), text.rfind(piece)) << "said twice: " << text;
    }
    EXPECT_FALSE(contains(told(maps, 0), "outputs"));  // the default list holds a format of hair
}

TEST(Help, ShowsEveryDefaultAndEveryFieldWithUnitAndRange) {
    const auto schema = nlohmann::json::parse(hairbake("presets --schema").output);
    for (const std::string command : {"bake", "submit", "render"}) {
        const std::string help = told(command + " --help", 0);
        for (const char* row :
             {"transmittance.directions                1 to 4096 (directions); default 100",
              "strand.width                            above 0, up to 1e+18 (model units); default none",
              "fiber.kajiya_kay.exponent               0 to 4096; default 64",
              "outputs                                 a list of npy, exr, hair, ktx2"})
            EXPECT_TRUE(contains(help, row)) << row;
        for (const auto& [block, property] : schema["properties"].items()) {
            if (!property.contains("properties")) continue;
            for (const auto& [name, field] : property["properties"].items())
                EXPECT_EQ(contains(help, "  " + block + "." + name), !field.value("deprecated", false)) << name;
        }
        EXPECT_TRUE(contains(help, "--progress MODE=auto"));
        EXPECT_TRUE(contains(help, "--preset NAME=default"));
    }
    const std::string bake = told("bake --help", 0), render = told("render --help", 0);
    EXPECT_TRUE(contains(bake, "texels per edge of a cube face; 4 to 256 (texels); default 16"));
    EXPECT_TRUE(contains(bake, "--threads N=0"));
    for (const char* option : {"--mode MODE=baked", "--directional KIND=auto", "--channel CHANNEL=beauty",
                               "--color R,G,B=0.78,0.52,0.3", "--size WxH=640x640", "--fov DEG=30", "--seed N=1"})
        EXPECT_TRUE(contains(render, option)) << option;
    for (const char* option : {"--style STYLE=straight", "--vertices N=1500000", "--map-width N=1024", "--seed N=1"})
        EXPECT_TRUE(contains(told("sample --help", 0), option)) << option;
    EXPECT_TRUE(contains(told("submit --help", 0), "--priority N=0"));
}

TEST(PresetsCommand, NamesTheDefault) {
    EXPECT_TRUE(
        contains(told("presets", 0), "default  Without --preset: 100 directions, 33 specular maps of 16x16x6."));
    const auto standard = nlohmann::json::parse(told("presets default", 0));
    EXPECT_EQ(standard["transmittance"]["directions"], 100);
    const Workshop workshop;
    const std::string quick = " --directions 9 --voxels 32";
    EXPECT_EQ(hairbake("bake" + workshop.hair() + workshop.out() + quick + " --preset default").exit_code, 0);
    EXPECT_EQ(hairbake("bake" + workshop.hair() + workshop.out("b") + quick).exit_code, 0);
    EXPECT_EQ(json_of(workshop.path("out/manifest.json"))["id"], json_of(workshop.path("b/manifest.json"))["id"]);
}

}  // namespace
}  // namespace hairbake::test_support
