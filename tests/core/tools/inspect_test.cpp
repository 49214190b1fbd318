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
    // The tips of the first two strands.
    const std::uint32_t tip = model.strand_begin[1] - 1;
    model.thickness[tip] = model.thickness[model.strand_begin[2] - 1] = 0;
    const std::string some = warnings(model);
    EXPECT_NE(some.find("2 of the model's 3000 vertices have no strand width"), std::string::npos) << some;
    EXPECT_NE(some.find("the first at strand 0, vertex " + std::to_string(tip)), std::string::npos) << some;
    std::fill(model.thickness.begin(), model.thickness.end(), 0.0f);
    EXPECT_NE(warnings(model).find("the model has no strand width"), std::string::npos);
    model.thickness.clear();
    model.default_thickness = 0;
    EXPECT_NE(warnings(model).find("the model has no strand width"), std::string::npos);
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
