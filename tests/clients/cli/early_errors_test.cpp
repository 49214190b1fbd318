// Errors come before the work, and lost output is an error.
#include <gtest/gtest.h>

#include <sstream>

#include "tests/clients/cli/cli.h"

namespace hairbake::test_support {
namespace {

/// The names of the phases in the JSON lines, and the last line.
struct Events {
    std::set<std::string> phases;
    nlohmann::json last;
};

Events events_of(const std::string& arguments) {
    const Finished run = hairbake(arguments + " --progress json 2>/dev/null");
    Events events;
    std::istringstream lines(run.output);
    for (std::string line; std::getline(lines, line);) {
        events.last = nlohmann::json::parse(line);
        if (events.last["event"] == "progress") events.phases.insert(events.last["phase"].get<std::string>());
    }
    return events;
}

/// Six faces of 2 x 2 pixels; the last has 4 x 4.
void write_uneven_faces(const Workshop& workshop) {
    std::filesystem::create_directory(workshop.path("faces"));
    for (const std::string face : {"px", "nx", "py", "ny", "pz", "nz"}) {
        const int size = face == "nz" ? 4 : 2;
        const std::string edge = std::to_string(size);
        std::ofstream(workshop.path("faces/" + face + ".pfm"), std::ios::binary)
            << "PF\n"
            << edge << " " << edge << "\n-1.0\n"
            << std::string(std::size_t(12 * size * size), '\0');
    }
}

TEST(EarlyErrors, OfAnInputComeBeforeAnyPhase) {
    const Workshop workshop;
    write_uneven_faces(workshop);
    std::ofstream(workshop.path("broken.exr")) << "no picture";
    const std::string bake = "bake" + workshop.hair() + workshop.out();
    const std::pair<std::string, std::string> cases[] = {
        // The misspelled environment, then its relatives.
        {bake + " --env " + workshop.path("samples/skyy.hdr"), "skyy.hdr: there is no such file"},
        {bake + " --env " + workshop.path("broken.exr"), "broken.exr"},
        {bake + " --env " + workshop.path("faces"), "nz.pfm: the size is 4 x 4"},
        {bake + workshop.env() + " --layout vertical_cross", "not of vertical_cross"},
        {bake + workshop.env() + " --layout faces", "this is one picture"},
        {bake + workshop.env() + " --occluder " + workshop.path("none.obj"), "none.obj"},
        {bake + workshop.env() + " --receiver " + workshop.path("samples"), "samples"},
        {"bake --hair " + workshop.path("broken.exr") + workshop.env() + workshop.out(), "no hair model"},
        {bake + workshop.env() + " --outputs glb,vdb --transmittance-method opacity_maps", "vdb"},
    };
    for (const auto& [arguments, piece] : cases) {
        const Events events = events_of(arguments);
        EXPECT_EQ(events.phases, std::set<std::string>{}) << arguments;
        EXPECT_EQ(events.last["event"], "error") << arguments;
        EXPECT_TRUE(contains(events.last["message"], piece)) << events.last["message"];
    }
}

TEST(EarlyErrors, OfInvalidRadianceComeBeforeTheTransmittance) {
    const Workshop workshop;
    std::string pixels(4 * 2 * 12, '\0');
    const float nan = std::numeric_limits<float>::quiet_NaN();
    std::memcpy(pixels.data(), &nan, sizeof nan);
    std::ofstream(workshop.path("nan.pfm"), std::ios::binary) << "PF\n4 2\n-1.0\n" << pixels;
    const std::string inputs = workshop.hair() + " --env " + workshop.path("nan.pfm");
    const std::set<std::string> reading{"read_hair", "read_environment"};
    for (const std::string& arguments : {"bake" + inputs + workshop.out(),
                                         // Relatives: pictures whose mode needs no maps, and one that does.
                                         "render" + inputs + " --mode brute --size 8x8 --out " + workshop.path("a.exr"),
                                         "render" + inputs + " --size 8x8 --out " + workshop.path("a.exr")}) {
        const Events events = events_of(arguments);
        EXPECT_TRUE(std::includes(reading.begin(), reading.end(), events.phases.begin(), events.phases.end()))
            << arguments;
        EXPECT_TRUE(contains(events.last["message"], "invalid_radiance")) << events.last;
    }
    EXPECT_EQ(hairbake("bake" + inputs + workshop.out() + " --invalid-radiance clamp --preset draft").exit_code, 0);
}

TEST(EarlyErrors, OfAPlaceThatCannotBeWrittenComeBeforeAnyPhase) {
    const Workshop workshop;
    std::filesystem::create_directory(workshop.path("a.png"));
    const std::string inputs = workshop.hair() + workshop.env();
    const std::pair<std::string, std::string> cases[] = {
        {"bake" + inputs + " --out /proc/hairbake/out", "/proc/hairbake/out cannot be written"},
        // Relatives: below a file, a mount point, pictures.
        {"bake" + inputs + " --out " + workshop.path("samples/sky.hdr/out"), "sky.hdr/out"},
        {"bake" + inputs + " --out /proc", "mount point"},
        {"render" + inputs + " --out " + workshop.path("none/a.png"), "make it first"},
        {"render" + inputs + " --out " + workshop.path("a.png"), "Is a directory"},
        {"render" + inputs + " --out " + workshop.path("b.png") + " --out /proc/b.exr", "/proc/b.exr"},
    };
    for (const auto& [arguments, piece] : cases) {
        const Events events = events_of(arguments);
        EXPECT_EQ(events.phases, std::set<std::string>{}) << arguments;
        EXPECT_TRUE(contains(events.last["message"], piece)) << events.last["message"];
    }
    for (const std::string& arguments :
         {std::string("sample /proc/hairbake"), "sample " + workshop.path("a.png") + "/../samples/sky.hdr",
          "diff " + workshop.path("samples/sky.hdr") + " " + workshop.path("samples/studio.hdr") + " --out " +
              workshop.path("none/d.png")})
        EXPECT_EQ(hairbake(arguments + " 2>&1").exit_code, 3) << arguments;
    EXPECT_EQ(workshop.names(), (std::vector<std::string>{"a.png", "samples"}));
}

TEST(EarlyErrors, OfAPictureComeBeforeAnyPhase) {
    const Workshop workshop;
    ASSERT_EQ(hairbake(workshop.quick_bake()).exit_code, 0);
    std::ofstream(workshop.path("camera.json")) << R"({"eye": [0, 0, 1], "targt": [0, 0, 0]})";
    const std::string inputs = workshop.hair() + workshop.env(), png = " --out " + workshop.path("a.png");
    const std::pair<std::string, std::string> cases[] = {
        {inputs + " --out " + workshop.path("a.jpg"), ".exr or .png"},
        // Relatives: no ending, one of two, the camera, the mesh, the mode, a size, the input itself.
        {inputs + " --out " + workshop.path("a"), ".exr or .png"},
        {inputs + png + " --out " + workshop.path("a.tif"), "a.tif"},
        {inputs + png + " --camera " + workshop.path("camera.json"), "targt"},
        {inputs + png + " --mesh " + workshop.path("none.obj"), "none.obj"},
        {inputs + png + " --mode directional", "transmittance.sh_bands"},
        {inputs + png + " --size 99999x5", "1 to 16384"},
        {inputs + png + " --env " + workshop.path("none.hdr"), "none.hdr"},
        {" " + workshop.path("samples") + png, "manifest.json"},
        {workshop.hair() + " --env " + workshop.path("out/diffuse_latlong.exr") + " --out " +
             workshop.path("out/diffuse_latlong.exr"),
         "which is the environment"},
    };
    for (const auto& [arguments, piece] : cases) {
        const std::string render = contains(arguments, "none.hdr")
                                       ? "render" + workshop.hair() + png + " --env " + workshop.path("none.hdr")
                                       : "render" + arguments;
        const Events events = events_of(render);
        EXPECT_EQ(events.phases, std::set<std::string>{}) << render;
        EXPECT_TRUE(contains(events.last["message"], piece)) << render << events.last["message"];
    }
    const Events own =
        events_of("render " + workshop.path("out") + workshop.env() + " --out " + workshop.path("out/preview.png"));
    EXPECT_TRUE(contains(own.last["message"], "which is the result's file preview.png")) << own.last;
    EXPECT_FALSE(std::filesystem::exists(workshop.path("a.png")));
    const Finished upper = hairbake("render " + workshop.path("out") + " --size 8x8 --samples 1 --out " +
                                    workshop.path("A.PNG") + workshop.env());
    EXPECT_EQ(upper.exit_code, 0) << upper.output;
}

TEST(EarlyErrors, AnInputInTheResultFolderStaysThere) {
    const Workshop workshop;
    ASSERT_EQ(hairbake(workshop.quick_bake()).exit_code, 0);
    std::filesystem::create_symlink(workshop.path("out/transmittance.hair"), workshop.path("link.hair"));
    const std::string hair = " --hair " + workshop.path("out/transmittance.hair");
    const std::string to_server = " --server http://127.0.0.1:1 --patience 0";
    for (
        const std::string& arguments : {
            "bake" + hair + workshop.out(),
            // Relatives: a link, other inputs, a folder of faces, another spelling, the request file, a fetched result.
            "bake --hair " + workshop.path("link.hair") + workshop.out(),
            "bake" + workshop.hair() + " --env " + workshop.path("out/diffuse_latlong.exr") + workshop.out(),
            "bake" + workshop.hair() + " --env " + workshop.path("out") + workshop.out(),
            "bake" + workshop.hair() + " --occluder " + workshop.path("out/preview.png") + workshop.out(),
            "bake" + hair + " --out " + workshop.path("samples/../out/"),
            "bake" + workshop.hair() + workshop.out() + " --request " + workshop.path("out/environment_sh.json"),
            "submit" + hair + to_server + " --fetch " + workshop.path("out"),
        }) {
        const Finished run = hairbake(arguments + " 2>&1");
        EXPECT_EQ(run.exit_code, 2) << arguments << run.output;
    }
    EXPECT_TRUE(contains(hairbake("bake" + hair + workshop.out() + " 2>&1").output, "lies in the result folder"));
    EXPECT_TRUE(std::filesystem::exists(workshop.path("out/transmittance.hair")));
    EXPECT_EQ(hairbake("bake" + hair + workshop.out("other") + " --preset draft").exit_code, 0);
}

TEST(LostOutput, IsAnErrorOfEveryCommand) {
    const Workshop workshop;
    ASSERT_EQ(hairbake(workshop.quick_bake()).exit_code, 0);
    const std::string sky = workshop.path("samples/sky.hdr"), out = workshop.path("out");
    for (const std::string& arguments : {
             "info " + workshop.path("samples/groom.hair"),
             std::string("presets"),
             std::string("presets --schema"),
             "compare " + out + " " + out,
             "diff " + sky + " " + sky,
             workshop.quick_bake() + " --progress json",
             // Relatives: other forms of these, help, version, other commands.
             "info --json " + out,
             std::string("completion bash"),
             std::string("presets draft"),
             "compare --json " + out + " " + out,
             workshop.quick_bake(),
             std::string("--help"),
             std::string("bake --help"),
             std::string("--version"),
             "sample " + workshop.path("other") + " --vertices 100 --map-width 16",
             "render " + out + workshop.env() + " --size 8x8 --samples 1 --out " + workshop.path("a.png"),
             "render " + out + workshop.env() + " --size 8x8 --progress json --out " + workshop.path("a.png"),
         }) {
        const bool compare = arguments.starts_with("compare");  // whose code of every error is 2
        EXPECT_EQ(hairbake(arguments + " >/dev/full 2>&1").exit_code, compare ? 2 : 4) << arguments;
        const Finished full = hairbake(arguments + " 2>&1 >/dev/full");
        EXPECT_TRUE(contains(full.output, "standard output cannot be written: No space left")) << full.output;
        EXPECT_EQ(hairbake(arguments + " 2>/dev/null >&-").exit_code, compare ? 2 : 3) << arguments;
    }
    // The result of a bake was written before its line, and is whole.
    EXPECT_EQ(hairbake("info " + out).exit_code, 0);
}

}  // namespace
}  // namespace hairbake::test_support
