#include "server/jobs/stage_plan.h"

#include <gtest/gtest.h>

namespace hairbake {
namespace {

TEST(StagePlan, AStagePlannedFromItsOwnRequestHasTheSameKeys) {
    BakeRequest request;
    request.hair = "sha256:" + std::string(64, 'a');
    request.environment = "sha256:" + std::string(64, 'b');
    request.occluder = "sha256:" + std::string(64, 'c');
    for (const auto& outputs :
         std::vector<std::vector<std::string>>{{"npy"}, {"ktx2", "npy"}, {"vdb"}, {"npy", "ktx2", "vdb"}, {}}) {
        request.outputs = outputs;
        request.transmittance.voxels = request.transmittance.voxels.value_or(64) + 32;
        for (const StagePlan& stage : plan_bake(request).stages) {
            const std::optional<StagePlan> again = plan_stage_again(stage.kind, stage.request);
            ASSERT_TRUE(again);
            EXPECT_EQ(again->key, stage.key);
            EXPECT_EQ(again->core_key, stage.core_key);
            EXPECT_EQ(again->request, stage.request);
            EXPECT_EQ(again->inputs, stage.inputs);
        }
    }
}

TEST(StagePlan, AStageOrARequestThatThisVersionDoesNotKnowHasNoPlan) {
    EXPECT_FALSE(plan_stage_again("a stage of tomorrow", "{}"));
    EXPECT_FALSE(plan_stage_again("transmittance", R"({"field of tomorrow": 1})"));
}

}  // namespace
}  // namespace hairbake
