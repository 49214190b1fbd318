#include "core/request/stages.h"

#include <gtest/gtest.h>

#include "core/request/request_json.h"

namespace hairbake {
namespace {

const InputDigests files{{"hair", "aa"}, {"environment", "bb"}};

BakeRequest hair_and_environment() {
    BakeRequest request;
    request.hair = "a.hair";
    request.environment = "b.hdr";
    return request;
}

std::string key_of(std::string_view stage, const BakeRequest& request, const InputDigests& digests = files) {
    return stage_key(*find_stage(stage), digests, request);
}

std::string id_of(const BakeRequest& request) {
    return bake_id({{"transmittance", key_of("transmittance", request)}, {"irradiance", key_of("irradiance", request)}},
                   request);
}

TEST(Stages, AreFoundByNameAndAskedForByTheirInputs) {
    for (const Stage& stage : stages()) EXPECT_EQ(find_stage(stage.name), &stage);
    EXPECT_EQ(find_stage("render"), nullptr);
    const auto names = [](const BakeRequest& request) {
        std::vector<std::string> list;
        for (const Stage* stage : stages_of(request)) list.emplace_back(stage->name);
        return list;
    };
    BakeRequest request = hair_and_environment();
    EXPECT_EQ(names(request), (std::vector<std::string>{"transmittance", "irradiance"}));
    request.hair.reset();
    EXPECT_EQ(names(request), std::vector<std::string>{"irradiance"});
}

TEST(StageKeys, EveryFieldIsInTheKeysOfTheStagesThatReadItAndInNoOther) {
    const std::tuple<const char*, const char*, const char*> changes[] = {
        {"strand.width", "0.5", "transmittance effective_transmittance"},
        {"strand.width_scale", "2", "transmittance effective_transmittance"},
        {"strand.opacity", "from_file", "transmittance effective_transmittance"},
        {"strand.time", "1.5", "transmittance effective_transmittance"},
        {"transmittance.method", "trace", "transmittance effective_transmittance"},
        {"transmittance.directions", "81", "transmittance effective_transmittance"},
        {"transmittance.direction_set", "random", "transmittance"},
        {"transmittance.seed", "2", "transmittance"},
        {"transmittance.voxels", "64", "transmittance effective_transmittance"},
        {"transmittance.voxel_size", "0.1", "transmittance effective_transmittance"},
        {"transmittance.sh_bands", "2", "transmittance"},
        {"transmittance.bent_cone", "true", "transmittance"},
        {"transmittance.opacity_maps.layers", "4", "transmittance"},
        {"transmittance.opacity_maps.layer_spacing", "1", "transmittance"},
        {"transmittance.opacity_maps.resolution", "64", "transmittance"},
        {"transmittance.reference_vertices", "5", "transmittance"},
        {"fiber.kajiya_kay.exponent", "5", "irradiance effective_transmittance"},
        {"environment_settings.layout", "latlong", "irradiance effective_transmittance"},
        {"environment_settings.latlong", "openexr", "irradiance effective_transmittance"},
        {"environment_settings.rotation_deg", "0,1,0", "irradiance effective_transmittance"},
        {"environment_settings.exposure_stops", "2", "irradiance effective_transmittance"},
        {"environment_settings.tint", "1,1,2", "irradiance effective_transmittance"},
        {"environment_settings.invalid_radiance", "clamp", "irradiance effective_transmittance"},
        {"environment_settings.to_primaries", "acescg", "irradiance effective_transmittance"},
        {"irradiance.face_size", "8", "irradiance"},
        {"irradiance.specular_maps", "9", "irradiance"},
        {"irradiance.method", "sh", "irradiance"},
        {"irradiance.sh_bands.diffuse", "4", "irradiance"},
        {"irradiance.sh_bands.specular", "4", "irradiance"},
        {"irradiance.sh_error", "0.1", "irradiance"},
        {"irradiance.clamp_negative", "false", "irradiance"},
        {"irradiance.lights", R"([{"direction": [0, 1, 0], "irradiance": [1, 1, 1]}])",
         "irradiance effective_transmittance"},
        {"effective_transmittance.enabled", "true", "effective_transmittance"},
        {"effective_transmittance.lights", "16", "effective_transmittance"},
        {"effective_transmittance.cosines", "4", "effective_transmittance"},
        {"effective_transmittance.diffuse", "luminance", "effective_transmittance"},
        {"effective_transmittance.reference_neighborhoods", "9", "effective_transmittance"}};
    std::size_t fields = 0;
    for (const std::string& path : field_paths()) fields += path.find('.') != std::string::npos ? 1 : 0;
    EXPECT_EQ(std::size(changes) + 1, fields) << "fiber.model has one value; all others are in the list";
    for (const auto& [path, value, readers] : changes) {
        BakeRequest request;
        set_field(request, path, value);
        for (const Stage& stage : stages())
            EXPECT_EQ(key_of(stage.name, BakeRequest{}) != key_of(stage.name, request),
                      (' ' + std::string(readers) + ' ').find(' ' + std::string(stage.name) + ' ') != std::string::npos)
                << path << ", " << stage.name;
    }
}

TEST(StageKeys, EveryInputOfTheStageCountsAtItsOwnPlace) {
    const BakeRequest request;
    const std::string bare = key_of("transmittance", request);
    EXPECT_NE(bare, key_of("transmittance", request, {{"hair", "cc"}}));
    EXPECT_NE(key_of("transmittance", request, {{"hair", "aa"}, {"occluder", "mm"}}),
              key_of("transmittance", request, {{"hair", "aa"}, {"receiver", "mm"}}));
    EXPECT_EQ(bare, key_of("transmittance", request, {{"hair", "aa"}})) << "the environment is not read";
    EXPECT_NE(key_of("irradiance", request), key_of("irradiance", request, {{"environment", "cc"}}));
}

TEST(StageKeys, PathsAndTheOrderOfOutputsAreInNoKey) {
    BakeRequest request;
    const std::string transmittance = key_of("transmittance", request), irradiance = key_of("irradiance", request),
                      id = id_of(request);
    request = hair_and_environment();
    request.occluder = request.receiver = "/somewhere/else.obj";
    request.outputs = {"hair", "exr", "npy"};
    EXPECT_EQ(transmittance, key_of("transmittance", request));
    EXPECT_EQ(irradiance, key_of("irradiance", request));
    EXPECT_EQ(id, id_of(request));
    request.outputs = {"npy"};
    EXPECT_NE(id, id_of(request));
}

TEST(RequestAlone, HoldsWhatTheStageReadsAndNothingElse) {
    BakeRequest request = hair_and_environment();
    request.strand.width = 0.5;
    request.irradiance.face_size = 8;
    request.environment_settings.exposure_stops = 1;
    request.outputs = {"vdb", "raw", "exr", "npy"};
    const BakeRequest hair = request_alone(*find_stage("transmittance"), request);
    EXPECT_EQ(hair.hair, "a.hair");
    EXPECT_FALSE(hair.environment);
    EXPECT_EQ(hair.strand.width, 0.5);
    EXPECT_EQ(hair.irradiance.face_size, BakeRequest{}.irradiance.face_size);
    EXPECT_EQ(hair.outputs, (std::vector<std::string>{"npy", "raw", "vdb"}));
    const BakeRequest maps = request_alone(*find_stage("irradiance"), request);
    EXPECT_FALSE(maps.hair);
    EXPECT_FALSE(maps.strand.width);
    EXPECT_EQ(maps.environment, "b.hdr");
    EXPECT_EQ(maps.irradiance.face_size, 8);
    EXPECT_EQ(maps.environment_settings.exposure_stops, 1);
    EXPECT_EQ(maps.outputs, (std::vector<std::string>{"exr", "npy", "raw"}));
    // What a stage alone is asked for has the key that it has in the whole bake.
    EXPECT_EQ(key_of("transmittance", hair), key_of("transmittance", request));
    EXPECT_EQ(key_of("irradiance", maps), key_of("irradiance", request));
}

TEST(PlannedPhases, FollowTheStagesAndTheirSharesSumToOne) {
    BakeRequest request = hair_and_environment();
    const auto names = [&] {
        std::vector<std::string> list;
        double sum = 0;
        for (const Phase& phase : planned_phases(stages_of(request), request)) {
            list.emplace_back(phase.name);
            sum += phase.share;
        }
        EXPECT_NEAR(sum, 1, 1e-12);
        return list;
    };
    // All inputs are read first: a fault in the environment must not be found after minutes of transmittance.
    EXPECT_EQ(names(), (std::vector<std::string>{"read_hair", "read_environment", "transmittance", "reference",
                                                 "irradiance", "write"}));
    request.transmittance.reference_vertices = 0;
    request.environment.reset();
    EXPECT_EQ(names(), (std::vector<std::string>{"read_hair", "transmittance", "write"}));
}

TEST(PlannedPhases, TheWholeNeverRunsBack) {
    const BakeRequest request = hair_and_environment();
    const std::vector<Phase> phases = planned_phases(stages_of(request), request);
    double whole = 0;
    for (const Phase& phase : phases)
        for (const double fraction : {0.0, 0.5, 1.0}) {
            EXPECT_GE(fraction_of_whole(phases, phase.name, fraction), whole - 1e-12) << phase.name;
            whole = fraction_of_whole(phases, phase.name, fraction);
        }
    EXPECT_NEAR(whole, 1, 1e-12);
    EXPECT_EQ(fraction_of_whole(phases, "render", 0.5), 0) << "a phase that is not planned";
}

}  // namespace
}  // namespace hairbake
