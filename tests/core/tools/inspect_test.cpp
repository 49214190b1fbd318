#include "core/tools/inspect.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/bake.h"
#include "core/hair/hair_file.h"
#include "core/hair/hair_format_writer.h"
#include "tests/support/small_inputs.h"

namespace hairbake {
namespace {

using Json = nlohmann::json;
using test_support::SmallInputs;

TEST(Inspect, TellsModelMapAndResultApart) {
    const SmallInputs inputs;
    BakeProgress progress;
    BakeResult result = bake(inputs.request(), 2, progress);
    write_result(result, inputs.folder / "out", progress);

    const Json hair = Json::parse(inspect(*inputs.request().hair, progress));
    EXPECT_EQ(hair["kind"], "hair model");
    EXPECT_EQ(hair["vertices"], 3000);
    const Json map = Json::parse(inspect(*inputs.request().environment, progress));
    EXPECT_EQ(map["kind"], "environment map");
    EXPECT_EQ(map["width"], 64);
    EXPECT_EQ(map["brightest_pixel"]["radiance"].size(), 3u);
    const Json baked = Json::parse(inspect(inputs.folder / "out", progress));
    EXPECT_EQ(baked["kind"], "bake result");
    EXPECT_EQ(baked["id"], result.id);
    EXPECT_TRUE(baked["files"].contains("transmittance.npy"));
    for (const char* block : {"stages", "inputs", "transmittance", "error_bar", "repairs", "warnings", "versions"})
        EXPECT_TRUE(baked.contains(block)) << block;
    EXPECT_FALSE(baked.contains("irradiance"));  // one entry for each map: too long
}

TEST(Inspect, ASunIsCountedInPixelsAndShareOfTheLight) {
    // The generated sunny sky has about 60 % of its light in a sun 0.53 degrees across, which 64 columns of 5.6 degrees
    // show as one to four pixels; the overcast one has none.
    const SmallInputs inputs;
    BakeProgress progress;
    const Json sunny = Json::parse(inspect(inputs.folder / "samples" / "sky.hdr", progress))["small_lights"];
    EXPECT_GE(sunny["pixels"], 1);
    EXPECT_LE(sunny["pixels"], 4);
    EXPECT_NEAR(sunny["share"].get<double>(), 0.6, 0.1);
    const Json overcast = Json::parse(inspect(inputs.folder / "samples" / "overcast.hdr", progress));
    EXPECT_FALSE(overcast.contains("small_lights"));
}

TEST(Inspect, WidthsThatABakeWillRefuseAreWarnedOf) {
    const SmallInputs inputs;
    BakeProgress progress;
    const auto warnings = [&](const HairModel& model) {
        write_hair(model, inputs.folder / "a.hair");
        const Json facts = Json::parse(inspect(inputs.folder / "a.hair", progress));
        return facts.contains("warnings") ? facts["warnings"].dump() : std::string();
    };
    HairModel model = read_hair(*inputs.request().hair);
    EXPECT_EQ(warnings(model), "");
    // A tip may be of width 0; a whole strand may not.
    const std::uint32_t tip = model.strand_begin[1] - 1;
    model.thickness[tip] = 0;
    EXPECT_EQ(warnings(model), "");
    const Json widths = Json::parse(inspect(inputs.folder / "a.hair", progress))["thickness"];
    EXPECT_EQ(widths["minimum"], 0);
    EXPECT_EQ(widths["vertices_of_width_0"], 1);
    EXPECT_GT(widths["mean"], 0);
    EXPECT_LT(widths["mean"], widths["maximum"]);
    std::fill(model.thickness.begin() + model.strand_begin[1], model.thickness.begin() + model.strand_begin[2], 0.0f);
    EXPECT_NE(warnings(model).find("all vertices of strand 1 is 0"), std::string::npos) << warnings(model);
    std::fill(model.thickness.begin(), model.thickness.end(), 0.0f);
    EXPECT_NE(warnings(model).find("the model has no strand width"), std::string::npos);
    model.thickness.clear();
    model.default_thickness = 0;
    EXPECT_NE(warnings(model).find("the model has no strand width"), std::string::npos);
}

// Relatives of the OBJ file: PLY, and an OBJ file with another extension; the manifest of a result.
TEST(Inspect, KnowsMeshesAndManifests) {
    const SmallInputs inputs;
    BakeProgress progress;
    const Json head = Json::parse(inspect(inputs.folder / "samples" / "head.obj", progress));
    EXPECT_EQ(head["kind"], "mesh");
    EXPECT_EQ(head["format"], "OBJ");
    EXPECT_EQ(head["triangles"], 36480);
    EXPECT_EQ(head["closed"], true);
    std::filesystem::copy_file(inputs.folder / "samples" / "head.obj", inputs.folder / "head.txt");
    EXPECT_EQ(Json::parse(inspect(inputs.folder / "head.txt", progress))["kind"], "mesh");
    std::ofstream(inputs.folder / "a")
        << "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
           "property float z\nelement face 1\nproperty list int int vertex_index\n"
           "end_header\n0 0 0 1 0 0 0 1 0 3 0 1 2\n";
    const Json ply = Json::parse(inspect(inputs.folder / "a", progress));
    EXPECT_EQ(ply["format"], "PLY, ASCII");
    EXPECT_EQ(ply["open_edges"], 3);
    std::ofstream(inputs.folder / "manifest.json") << R"({"format": "hairbake result", "id": "x", "files": []})";
    EXPECT_EQ(Json::parse(inspect(inputs.folder / "manifest.json", progress))["kind"], "bake result");
}

TEST(Inspect, OtherFilesAreBadInput) {
    const SmallInputs inputs;
    std::ofstream(inputs.folder / "text") << "neither hair nor picture";
    BakeProgress progress;
    for (const char* name : {"text", "missing", "samples"})
        EXPECT_THROW(inspect(inputs.folder / name, progress), Error);
}

TEST(Inspect, LinesShowNestedNamesWithDots) {
    const std::string lines = as_lines(R"({"kind": "x", "bounds": {"minimum": [1, 2.5, -3]}, "warnings": []})");
    EXPECT_NE(lines.find("bounds.minimum"), std::string::npos);
    EXPECT_NE(lines.find("1  2.5  -3"), std::string::npos);
    EXPECT_EQ(lines.find("warnings"), std::string::npos);
}

}  // namespace
}  // namespace hairbake
