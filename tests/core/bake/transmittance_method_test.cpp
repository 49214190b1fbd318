// `transmittance.method: auto`, and the directions of a traced bake.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "core/bake.h"
#include "core/hair/hair_format_writer.h"
#include "core/sample/groom_generator.h"
#include "core/stages/transmittance_method.h"
#include "tests/support/small_inputs.h"

namespace hairbake {
namespace {

namespace fs = std::filesystem;
using Method = TransmittanceMethod;
using test_support::SmallInputs;

TEST(TransmittanceMethod, AutoTracesUpToTheLimitAndSweepsBeyond) {
    TransmittanceSettings settings;
    for (const int directions : {32, 100, 256}) {
        settings.directions = directions;
        const std::size_t most = most_traced_points(directions);
        const auto method = [&](std::size_t vertices, std::size_t receiver) {
            return choose_method(settings, vertices, receiver).method;
        };
        EXPECT_EQ(method(0, 0), Method::trace);
        EXPECT_EQ(method(most, 0), Method::trace);
        EXPECT_EQ(method(most + 1, 0), Method::volume);
        EXPECT_EQ(method(most - 5, 5), Method::trace);
        EXPECT_EQ(method(most - 5, 6), Method::volume);
    }
    settings.directions = 100;
    EXPECT_EQ(choose_method(settings, 7, 3).reason,
              "auto: 7 vertices and 3 positions of the receiver; up to 20000 are traced with 100 directions");
}

TEST(TransmittanceMethod, MoreDirectionsAllowMorePointsToBeTraced) {
    EXPECT_EQ(most_traced_points(1), 5'000u);
    EXPECT_EQ(most_traced_points(32), 5'000u);    // draft
    EXPECT_EQ(most_traced_points(100), 20'000u);  // the default
    EXPECT_EQ(most_traced_points(200), 160'000u);
    EXPECT_EQ(most_traced_points(256), 250'000u);  // final
    EXPECT_EQ(most_traced_points(4096), 250'000u);
}

TEST(TransmittanceMethod, AMethodThatIsAskedForIsTaken) {
    for (const Method method : {Method::volume, Method::trace, Method::opacity_maps})
        for (const std::size_t vertices : {std::size_t{1}, std::size_t{1'000'000}}) {
            TransmittanceSettings settings;
            settings.method = method;
            EXPECT_EQ(choose_method(settings, vertices, 0).method, method);
            EXPECT_EQ(choose_method(settings, vertices, 0).reason, "as the request asks");
        }
}

TEST(TransmittanceMethod, TracingTakesMoreDirectionsOfWhichASquareNumberStaysSquare) {
    EXPECT_EQ(traced_directions(1), 9);
    EXPECT_EQ(traced_directions(100), 900);
    EXPECT_EQ(traced_directions(256), 2304);
    EXPECT_EQ(traced_directions(455), 4095);
    EXPECT_EQ(traced_directions(456), 1824);
    EXPECT_EQ(traced_directions(1024), 4096);
    EXPECT_EQ(traced_directions(1025), 1025);
    EXPECT_EQ(traced_directions(4096), 4096);
}

BakeResult baked(BakeRequest request, Method method) {
    request.environment.reset();
    request.transmittance.method = method;
    BakeProgress progress;
    return bake(request, 2, progress);
}

const std::vector<float>& average(const BakeResult& result) {
    return result.array(average_transmittance_kind())->values;
}

const TransmittanceFacts& facts(const BakeResult& result) {
    return std::get<TransmittanceFacts>(result.part("transmittance")->facts);
}

TEST(TransmittanceMethod, AutoIsTheTracedBakeOfASmallModelAndTheSweptOneOfALargerOne) {
    const SmallInputs inputs;
    BakeRequest request = inputs.request();
    request.transmittance.directions = 9;
    const BakeResult small = baked(request, Method::automatic);
    EXPECT_EQ(average(small), average(baked(request, Method::trace)));
    EXPECT_EQ(facts(small).method, Method::trace);
    EXPECT_EQ(facts(small).directions, 81);

    const fs::path file = inputs.folder / "larger.hair";
    GroomSettings groom;
    groom.vertices = most_traced_points(request.transmittance.directions) + 1000;
    write_hair(generate_groom(groom), file);
    request.hair = file.string();
    const BakeResult larger = baked(request, Method::automatic);
    ASSERT_GT(average(larger).size(), most_traced_points(request.transmittance.directions));
    EXPECT_EQ(average(larger), average(baked(request, Method::volume)));
    EXPECT_EQ(facts(larger).method, Method::volume);
    EXPECT_EQ(facts(larger).directions, 9);
}

TEST(TransmittanceMethod, ATracedBakeHasTheDensityOfTheSweptOne) {
    const SmallInputs inputs;
    BakeRequest request = inputs.request();
    request.transmittance.directions = 4;
    request.outputs = {"vdb"};
    const auto bytes = [&](Method method) {
        const fs::path folder = inputs.folder / "out";
        BakeResult result = baked(request, method);
        BakeProgress progress;
        write_result(result, folder, progress);
        std::ifstream stream(folder / "density.vdb", std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(stream), {});
    };
    const std::string swept = bytes(Method::volume);
    EXPECT_FALSE(swept.empty());
    EXPECT_EQ(bytes(Method::trace), swept);
}

}  // namespace
}  // namespace hairbake
