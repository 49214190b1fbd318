#include "core/bake.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

#include "core/base/digest.h"
#include "tests/core/bake/small_inputs.h"

namespace hairbake {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using test_support::SmallInputs;

std::string get(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// Bytes of every file of a result; of the manifest without what may differ between runs.
std::map<std::string, std::string> contents(const fs::path& folder) {
    std::map<std::string, std::string> found;
    for (const auto& entry : fs::directory_iterator(folder)) found[entry.path().filename()] = get(entry.path());
    Json manifest = Json::parse(found.at("manifest.json"));
    for (const char* name : {"timings_s", "peak_memory_bytes", "measured"}) manifest.erase(name);
    found["manifest.json"] = manifest.dump();
    return found;
}

void bake_to(const BakeRequest& request, const fs::path& folder, int threads = 2) {
    Progress progress;
    BakeResult result = bake(request, threads, progress);
    write_result(result, folder, progress);
}

TEST(Bake, SameRequestGivesTheSameBytesForOneTwoAndSevenThreads) {
    const SmallInputs inputs;
    BakeRequest request = inputs.request();
    request.transmittance.direction_set = DirectionSet::random;
    bake_to(request, inputs.folder / "1", 1);
    const auto expected = contents(inputs.folder / "1");
    for (const int threads : {1, 2, 7}) {
        bake_to(request, inputs.folder / "again", threads);
        const auto found = contents(inputs.folder / "again");
        ASSERT_EQ(found.size(), expected.size());
        for (const auto& [name, bytes] : expected)
            EXPECT_TRUE(found.at(name) == bytes) << name << " differs with " << threads << " threads";
    }
}

TEST(Bake, HairAloneBakesTransmittanceAndEnvironmentAloneMaps) {
    const SmallInputs inputs;
    BakeRequest hair = inputs.request(), environment = inputs.request();
    hair.environment.reset();
    environment.hair.reset();
    bake_to(hair, inputs.folder / "hair");
    bake_to(environment, inputs.folder / "environment");
    std::vector<std::string> names;
    for (const auto& [name, bytes] : contents(inputs.folder / "hair")) names.push_back(name);
    EXPECT_EQ(names,
              (std::vector<std::string>{"manifest.json", "preview.png", "transmittance.hair", "transmittance.npy"}));
    EXPECT_FALSE(fs::exists(inputs.folder / "environment" / "transmittance.npy"));
    for (const char* name : {"diffuse.npy", "specular.npy", "diffuse.exr", "specular_02_latlong.exr",
                             "environment_sh.json", "preview.png", "manifest.json"})
        EXPECT_TRUE(fs::exists(inputs.folder / "environment" / name)) << name;
}

TEST(Bake, StagesDoNotKnowOfEachOther) {
    const SmallInputs inputs;
    BakeRequest both = inputs.request(), hair = inputs.request(), environment = inputs.request();
    hair.environment.reset();
    environment.hair.reset();
    Progress progress;
    const BakeResult b = bake(both, 2, progress), h = bake(hair, 2, progress), e = bake(environment, 2, progress);
    EXPECT_EQ(b.transmittance_key, h.transmittance_key);
    EXPECT_EQ(b.irradiance_key, e.irradiance_key);
    EXPECT_EQ(b.transmittance->average, h.transmittance->average);
    EXPECT_EQ(b.irradiance->specular, e.irradiance->specular);
    EXPECT_NE(b.id, h.id);
    EXPECT_NE(b.id, e.id);
}

TEST(Bake, ManifestListsEveryFileWithItsDigestAndSize) {
    const SmallInputs inputs;
    bake_to(inputs.request(), inputs.folder / "out");
    const Json manifest = Json::parse(get(inputs.folder / "out" / "manifest.json"));
    std::size_t files = 1;  // the manifest itself
    for (const Json& entry : manifest["files"]) {
        const fs::path file = inputs.folder / "out" / entry["name"].get<std::string>();
        EXPECT_EQ(digest_of_file(file), entry["sha256"]) << file;
        EXPECT_EQ(fs::file_size(file), entry["bytes"]) << file;
        ++files;
    }
    EXPECT_EQ(contents(inputs.folder / "out").size(), files);
    EXPECT_EQ(manifest["inputs"]["hair"]["sha256"], digest_of_file(*inputs.request().hair));
}

TEST(Bake, EveryStageThatRanHasATime) {
    const SmallInputs inputs;
    Progress progress;
    BakeResult result = bake(inputs.request(), 2, progress);
    write_result(result, inputs.folder / "out", progress);
    ASSERT_EQ(result.measured.timings_s.size(), 6u);
    for (const auto& [stage, seconds] : result.measured.timings_s) EXPECT_GT(seconds, 0) << stage;
    EXPECT_GT(result.measured.peak_memory_bytes, 1u << 20);
    EXPECT_EQ(result.measured.threads, 2);
}

TEST(Bake, TraceGivesWhatTheErrorBarTracesWithTheSameDirections) {
    const SmallInputs inputs;
    BakeRequest request = inputs.request();
    request.environment.reset();
    request.transmittance.method = TransmittanceMethod::trace;
    request.transmittance.directions = 1024;  // as the error bar, Fibonacci as well
    Progress progress;
    const BakeResult result = bake(request, 2, progress);
    ASSERT_TRUE(result.error_bar.has_value());
    EXPECT_EQ(result.error_bar->rmse, 0);
    EXPECT_EQ(result.error_bar->bias, 0);
}

TEST(Bake, EveryMethodAnswersHarmonicsConesAndTheReceiver) {
    // The sample head as receiver: volume and trace agree in the mean over its points to a few hundredths.
    const SmallInputs inputs;
    BakeRequest request = inputs.request();
    request.environment.reset();
    request.receiver = (inputs.folder / "samples" / "head.obj").string();
    request.transmittance.sh_bands = 2;
    request.transmittance.bent_cone = true;
    request.transmittance.reference_vertices = 0;
    double mean[2] = {0, 0};
    for (const int trace : {0, 1}) {
        request.transmittance.method = trace ? TransmittanceMethod::trace : TransmittanceMethod::volume;
        Progress progress;
        const BakeResult result = bake(request, 2, progress);
        const std::size_t vertices = result.transmittance->average.size();
        EXPECT_EQ(result.transmittance->sh.size(), 4 * vertices);
        EXPECT_EQ(result.transmittance->bent_cone.size(), 4 * vertices);
        ASSERT_EQ(result.transmittance->receiver.size(), 2 * result.receiver->positions.size());
        for (const float t : result.transmittance->receiver)
            mean[trace] += double(t) / double(result.transmittance->receiver.size());
        EXPECT_EQ(result.hair_inputs.receiver, digest_of_file(*request.receiver));
        bake_to(request, inputs.folder / "result");
        for (const char* name : {"transmittance_sh.npy", "bent_cone.npy", "receiver.npy"})
            EXPECT_TRUE(fs::exists(inputs.folder / "result" / name)) << name;
    }
    EXPECT_LT(mean[1], 0.999);
    EXPECT_NEAR(mean[0], mean[1], 0.05);
}

TEST(Bake, WithoutReferenceVerticesThereIsNoErrorBarAndNoTimeForIt) {
    const SmallInputs inputs;
    BakeRequest request = inputs.request();
    request.transmittance.reference_vertices = 0;
    Progress progress;
    const BakeResult result = bake(request, 2, progress);
    EXPECT_FALSE(result.error_bar.has_value());
    EXPECT_EQ(result.measured.timings_s.at("reference"), 0);
}

/// Cancels itself at the first report of a stage.
class CancelAt : public Progress {
public:
    explicit CancelAt(std::string stage) : stage_(std::move(stage)) {}
    void report(std::string_view stage, double) override {
        if (stage == stage_) cancel();
    }

private:
    std::string stage_;
};

TEST(Bake, CancelledInAnyStageLeavesNothing) {
    const SmallInputs inputs;
    for (const char* stage : {"read_hair", "transmittance", "reference", "read_environment", "irradiance", "write"}) {
        CancelAt progress(stage);
        try {
            BakeResult result = bake(inputs.request(), 2, progress);
            write_result(result, inputs.folder / "out", progress);
            ADD_FAILURE() << stage << " went on";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::cancelled) << stage;
        }
        std::size_t entries = 0;
        for ([[maybe_unused]] const auto& entry : fs::directory_iterator(inputs.folder / "")) ++entries;
        EXPECT_EQ(entries, 1u) << "only the samples are there after " << stage;
    }
}

TEST(Bake, ReportsStagesInOrderWithFractionsFromZeroToOne) {
    class Recorder : public Progress {
    public:
        void report(std::string_view stage, double fraction) override {
            const std::lock_guard lock(mutex_);
            if (stages.empty() || stages.back() != stage) stages.emplace_back(stage);
            EXPECT_GE(fraction, 0);
            EXPECT_LE(fraction, 1);
        }
        std::vector<std::string> stages;

    private:
        std::mutex mutex_;
    } progress;
    const SmallInputs inputs;
    BakeResult result = bake(inputs.request(), 2, progress);
    write_result(result, inputs.folder / "out", progress);
    EXPECT_EQ(progress.stages, (std::vector<std::string>{"read_hair", "transmittance", "reference", "read_environment",
                                                         "irradiance", "write"}));
}

TEST(Bake, MissingAndBrokenInputsAreBadInputThatNamesTheFile) {
    const SmallInputs inputs;
    std::ofstream(inputs.folder / "broken.hair") << "HAIR but not really";
    std::ofstream(inputs.folder / "broken.hdr") << "#?RADIANCE and nothing";
    for (const char* name : {"missing.hair", "broken.hair", "missing.hdr", "broken.hdr"}) {
        BakeRequest request = inputs.request();
        (std::string(name).ends_with("hair") ? request.hair : request.environment) = (inputs.folder / name).string();
        Progress progress;
        try {
            bake(request, 2, progress);
            ADD_FAILURE() << name;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::bad_input) << name;
            EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
        }
    }
}

}  // namespace
}  // namespace hairbake
