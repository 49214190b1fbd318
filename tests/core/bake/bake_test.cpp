#include "core/bake.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

#include "core/base/digest.h"
#include "core/base/error.h"
#include "core/hair/hair_file.h"
#include "core/hair/hair_format_writer.h"
#include "core/mesh/mesh_file.h"
#include "core/sample/head_mesh.h"
#include "tests/support/small_inputs.h"
#include "tests/support/tfx_bytes.h"

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
    BakeProgress progress;
    BakeResult result = bake(request, threads, progress);
    write_result(result, folder, progress);
}

const std::optional<ErrorBar>& error_bar_of(const BakeResult& result) {
    return std::get<TransmittanceFacts>(result.part("transmittance")->facts).error_bar;
}

TEST(Bake, SameRequestGivesTheSameBytesForOneTwoAndSevenThreads) {
    const SmallInputs inputs;
    BakeRequest request = inputs.request();
    request.transmittance.direction_set = DirectionSet::random;
    request.outputs = output_formats();
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

TEST(Bake, AnOccluderDarkensTheHairAndTheManifestTellsWhatItIs) {
    const SmallInputs inputs;
    BakeRequest request = inputs.request();
    request.environment.reset();
    BakeProgress progress;
    BakeResult bare = bake(request, 2, progress);
    request.occluder = (inputs.folder / "samples" / "head.obj").string();
    for (const auto method : {TransmittanceMethod::volume, TransmittanceMethod::trace}) {
        request.transmittance.method = method;
        BakeResult result = bake(request, 2, progress);
        EXPECT_NE(result.part("transmittance")->key, bare.part("transmittance")->key);
        write_result(result, inputs.folder / "out", progress);
        const Json manifest = Json::parse(get(inputs.folder / "out" / "manifest.json"));
        const Json& occluder = manifest["inputs"]["occluder"];
        EXPECT_EQ(occluder["sha256"], digest_of_file(*request.occluder));
        EXPECT_EQ(occluder["triangles"], 36480);  // 96 rings of 192 columns: 2 x 192 x 95
        EXPECT_EQ(occluder["closed"], true);
        EXPECT_EQ(manifest["warnings"], Json::array());
        // The hair of 3,000 vertices is thin: the head alone takes about half of a root's sky.
        EXPECT_LT(manifest["transmittance"]["mean"].get<double>(), 0.9);
        EXPECT_LT(result.array(average_transmittance_kind())->values[0], 0.55f);
        EXPECT_LT(std::abs(manifest["error_bar"]["bias"].get<double>()), 0.05);
    }
    // Without its last triangle it is a shell.
    std::string text = get(*request.occluder);
    text.resize(text.rfind("\nf ") + 1);
    std::ofstream(inputs.folder / "open.obj") << text;
    request.occluder = (inputs.folder / "open.obj").string();
    const BakeResult open = bake(request, 2, progress);
    EXPECT_FALSE(open.inputs.occluder->topology.closed);
    ASSERT_EQ(open.warnings.size(), 1u);
    EXPECT_NE(open.warnings[0].find("3 of its"), std::string::npos) << open.warnings[0];
}

// Relatives: 100 times too large and too small, z-up, and the same faults of a receiver.
TEST(Bake, WarnsOfAMeshInAnotherUnitOrFrame) {
    const SmallInputs inputs;
    BakeRequest request = inputs.request();
    request.environment.reset();
    const std::string head = (inputs.folder / "samples" / "head.obj").string(),
                      other = (inputs.folder / "other.obj").string();
    const auto warnings_with = [&](const auto& change, bool as_receiver) {
        TriangleMesh mesh = read_mesh(head);
        for (Vec3f& p : mesh.positions) p = change(p);
        write_obj(mesh, other);
        request.occluder = as_receiver ? head : other;
        request.receiver.reset();
        if (as_receiver) request.receiver = other;
        BakeProgress progress;
        const BakeResult result = bake(request, 2, progress);
        if (!as_receiver) {
            EXPECT_GT(result.inputs.occluder->vertices_looked_at, 0u);
        }
        return Json(result.warnings).dump();
    };
    const auto larger = [](const Vec3f& p) { return p * 100.0f; };
    const auto smaller = [](const Vec3f& p) { return p * 0.01f; };
    const auto z_up = [](const Vec3f& p) { return Vec3f(p.x, -p.z, p.y); };
    std::string found = warnings_with(larger, false);
    EXPECT_NE(found.find("the occluder: the hair's roots are not on it, but would be if it were 100 times smaller"),
              std::string::npos)
        << found;
    EXPECT_NE(found.find("lie inside it, where A is 0"), std::string::npos) << found;
    EXPECT_NE(warnings_with(smaller, false).find("100 times larger"), std::string::npos);
    EXPECT_NE(warnings_with(z_up, false).find("the mesh is z-up"), std::string::npos);
    EXPECT_NE(warnings_with(larger, true).find("the receiver: the hair's roots are not on it"), std::string::npos);
    EXPECT_NE(warnings_with(z_up, true).find("the mesh is z-up"), std::string::npos);
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

TEST(Bake, TakesATressFxFileAndCountsItsDegenerateSegments) {
    const SmallInputs inputs;
    // Two strands of four points at (i, 0.5 i, -i), i = 0 .. 7; then point 1 moves to within 1e-6 of point 0: a segment
    // below 1e-6 of the longest side, which is 7.
    test_support::HairBytes file = test_support::make_tfx_bytes(4, 2, 4);
    std::uint32_t positions = 0;
    std::memcpy(&positions, file.bytes.data() + test_support::kTfx4.positions, 4);
    file.set(positions + 16, 1e-6f).set(positions + 20, 0.f).set(positions + 24, 0.f);
    std::ofstream(inputs.folder / "two.tfx", std::ios::binary)
        .write(reinterpret_cast<const char*>(file.bytes.data()), static_cast<std::streamsize>(file.bytes.size()));
    BakeRequest request = inputs.request();
    request.environment.reset();
    request.hair = (inputs.folder / "two.tfx").string();
    EXPECT_THROW(bake_to(request, inputs.folder / "out"), Error);  // it has no width
    request.strand.width = 0.01;
    bake_to(request, inputs.folder / "out");
    const Json manifest = Json::parse(get(inputs.folder / "out" / "manifest.json"));
    EXPECT_EQ(manifest["inputs"]["hair"]["segments"], 6);
    EXPECT_EQ(manifest["repairs"]["hair"]["degenerate_segments"], 1);
    const HairModel baked = read_hair(inputs.folder / "out" / "transmittance.hair");
    EXPECT_EQ(baked.format, "HAIR");
    EXPECT_EQ(baked.vertex_count(), 8u);
    EXPECT_EQ(baked.strand_count(), 2u);
}

TEST(Bake, TakesTheMethodOfOpacityMaps) {
    const SmallInputs inputs;
    BakeRequest request = inputs.request();
    request.environment.reset();
    request.transmittance.method = TransmittanceMethod::opacity_maps;
    request.transmittance.opacity_maps.resolution = 64;
    BakeProgress progress;
    const BakeResult maps = bake(request, 2, progress);
    EXPECT_EQ(maps.array(average_transmittance_kind())->values.size(), 3000u);
    EXPECT_TRUE(error_bar_of(maps).has_value());
    request.transmittance.opacity_maps.layers = 4;
    EXPECT_NE(bake(request, 2, progress).part("transmittance")->key, maps.part("transmittance")->key);
}

TEST(Bake, WritesEveryOutputAndTheManifestKnowsItsDigestSizeAndScale) {
    const SmallInputs inputs;
    BakeRequest request = inputs.request();
    request.outputs = {"ktx2", "dds", "raw", "glb", "vdb"};
    request.environment_settings.exposure_stops = 20;  // beyond halves
    bake_to(request, inputs.folder / "result");
    const Json manifest = Json::parse(get(inputs.folder / "result" / "manifest.json"));
    std::map<std::string, Json> files;
    for (const Json& file : manifest["files"]) files[file["name"]] = file;
    for (const char* name : {"diffuse.ktx2", "specular.ktx2", "diffuse.dds", "specular_02.dds", "maps.f16"})
        EXPECT_GT(files[name].value("scale", 0.0), 1.0) << name;
    for (const char* name : {"maps.json", "strands.bin", "strands.json", "hair.glb", "density.vdb"})
        EXPECT_TRUE(files.contains(name) && !files[name].contains("scale")) << name;
    for (const auto& [name, file] : files) {
        EXPECT_EQ(file["sha256"], digest_of_file(inputs.folder / "result" / name)) << name;
        EXPECT_EQ(file["bytes"], fs::file_size(inputs.folder / "result" / name)) << name;
    }
    EXPECT_EQ(files.size(), 12u + 2);  // 4 dds, 2 ktx2, 2 + 2 raw, glb, vdb; environment_sh.json and preview.png
}

TEST(Bake, AnEmptyModelHasNoDensityGridWhichIsAWarning) {
    const test_support::TemporaryFolder folder;
    HairModel none;
    none.strand_begin = {0};
    write_hair(none, folder / "none.hair");
    BakeRequest request;
    request.hair = (folder / "none.hair").string();
    request.outputs = {"raw", "glb", "vdb"};
    bake_to(request, folder / "result");
    EXPECT_FALSE(fs::exists(folder / "result" / "density.vdb"));
    EXPECT_TRUE(fs::exists(folder / "result" / "hair.glb"));
    const std::string warnings = Json::parse(get(folder / "result" / "manifest.json"))["warnings"].dump();
    EXPECT_NE(warnings.find("density.vdb is left out"), std::string::npos) << warnings;
}

TEST(Bake, WhatIsWrongWithTheHairsNumbersBeginsWithItsFile) {
    const SmallInputs inputs;
    BakeRequest request = inputs.request();
    const auto refusal = [&](const HairModel& model) {
        write_hair(model, *request.hair);
        BakeProgress progress;
        try {
            bake(request, 2, progress);
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::bad_input);
            return std::string(error.what());
        }
        return std::string("was accepted");
    };
    const HairModel model = read_hair(*request.hair);
    HairModel thin = model, stray = model, tiny = model;
    thin.thickness[3] = -0.5f;
    EXPECT_TRUE(refusal(thin).starts_with(*request.hair + ": the strand width at strand 0, vertex 3 is -0.5"))
        << refusal(thin);
    // 30 cm of hair: segments of some millimetres are far below 1e-6 * 1e9 = 1,000 units.
    stray.positions[4].x = 1e9f;
    EXPECT_TRUE(refusal(stray).starts_with(*request.hair + ": strand 0, vertex 4 lies 1e+09 units")) << refusal(stray);
    // 1e-33 times as large, widths too: voxels of about 1e-33 units, where 1e-30 is the least.
    for (Vec3f& p : tiny.positions) p *= 1e-33f;
    for (float& width : tiny.thickness) width *= 1e-33f;
    EXPECT_TRUE(refusal(tiny).starts_with(*request.hair + ": the hair model is ")) << refusal(tiny);
}

TEST(Bake, StagesDoNotKnowOfEachOther) {
    const SmallInputs inputs;
    BakeRequest both = inputs.request(), hair = inputs.request(), environment = inputs.request();
    hair.environment.reset();
    environment.hair.reset();
    BakeProgress progress;
    const BakeResult b = bake(both, 2, progress), h = bake(hair, 2, progress), e = bake(environment, 2, progress);
    EXPECT_EQ(b.part("transmittance")->key, h.part("transmittance")->key);
    EXPECT_EQ(b.part("irradiance")->key, e.part("irradiance")->key);
    const ArrayKind& average = average_transmittance_kind();
    EXPECT_EQ(b.array(average)->values, h.array(average)->values);
    EXPECT_EQ(b.part("irradiance")->maps->find("specular")->cubes, e.part("irradiance")->maps->find("specular")->cubes);
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
    BakeProgress progress;
    BakeRequest request = inputs.request();
    request.effective_transmittance.enabled = true;
    BakeResult result = bake(request, 2, progress);
    write_result(result, inputs.folder / "out", progress);
    std::map<std::string, double> timings = result.measured.timings_s;
    for (const Phase& phase : planned_phases(stages_of(result.request), result.request)) {
        EXPECT_GT(timings[std::string(phase.name)], 0) << phase.name;
        timings.erase(std::string(phase.name));
    }
    for (const auto& [phase, seconds] : timings) EXPECT_EQ(seconds, 0) << phase;  // of stages that did not run
    EXPECT_GT(result.measured.peak_memory_bytes, 1u << 20);
    EXPECT_EQ(result.measured.threads, 2);
}

TEST(Bake, TraceAgreesWithTheErrorBarWithinTheNoiseOfItsDirections) {
    const SmallInputs inputs;
    BakeRequest request = inputs.request();
    request.environment.reset();
    request.transmittance.method = TransmittanceMethod::trace;
    request.transmittance.directions = 1024;
    BakeProgress progress;
    const BakeResult result = bake(request, 2, progress);
    ASSERT_TRUE(error_bar_of(result).has_value());
    // Independent directions would err by at most 0.5 / sqrt(1024); Fibonacci directions are better. 20 vertices.
    const double most = 0.5 / 32;
    EXPECT_LT(error_bar_of(result)->outside.rmse, most);
    EXPECT_LT(std::abs(error_bar_of(result)->outside.bias), 4 * most / std::sqrt(20.0));
    EXPECT_GT(error_bar_of(result)->outside.noise, 0);
    EXPECT_LT(error_bar_of(result)->outside.noise, most / 2) << "four times as many directions";
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
        BakeProgress progress;
        const BakeResult result = bake(request, 2, progress);
        const std::size_t vertices = result.array(average_transmittance_kind())->values.size();
        EXPECT_EQ(result.array(transmittance_sh_kind())->values.size(), 4 * vertices);
        EXPECT_EQ(result.array(bent_cone_kind())->values.size(), 4 * vertices);
        ASSERT_EQ(result.array(receiver_kind())->values.size(), 2 * result.inputs.receiver->positions);
        for (const float t : result.array(receiver_kind())->values)
            mean[trace] += double(t) / double(result.array(receiver_kind())->values.size());
        EXPECT_EQ(result.inputs.digests.at("receiver"), digest_of_file(*request.receiver));
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
    BakeProgress progress;
    const BakeResult result = bake(request, 2, progress);
    EXPECT_FALSE(error_bar_of(result).has_value());
    EXPECT_EQ(result.measured.timings_s.at("reference"), 0);
}

/// Cancels itself when a phase begins.
class CancelAt : public BakeProgress {
public:
    explicit CancelAt(std::string phase) : phase_(std::move(phase)) {}
    void enter(std::string_view phase) override {
        if (phase == phase_) cancel();
    }

private:
    std::string phase_;
};

TEST(Bake, CancelledInAnyPhaseLeavesNothing) {
    const SmallInputs inputs;
    for (const char* phase : {"read_hair", "transmittance", "reference", "read_environment", "irradiance", "write"}) {
        CancelAt progress(phase);
        try {
            BakeResult result = bake(inputs.request(), 2, progress);
            write_result(result, inputs.folder / "out", progress);
            ADD_FAILURE() << phase << " went on";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::cancelled) << phase;
        }
        std::size_t entries = 0;
        for ([[maybe_unused]] const auto& entry : fs::directory_iterator(inputs.folder / "")) ++entries;
        EXPECT_EQ(entries, 1u) << "only the samples are there after " << phase;
    }
}

/// Records the phases, and checks that no report of a phase runs back: for bakes on one thread, whose reports are in
/// order.
class Recorder : public BakeProgress {
public:
    void enter(std::string_view phase) override {
        const std::lock_guard lock(mutex_);
        phases.emplace_back(phase);
        largest_ = 0;
    }
    void report(double fraction) override {
        const std::lock_guard lock(mutex_);
        EXPECT_GE(fraction, 0);
        EXPECT_LE(fraction, 1 + 1e-9);
        EXPECT_GE(fraction, largest_) << phases.back();
        largest_ = std::max(largest_, fraction);
    }
    std::vector<std::string> phases;

private:
    std::mutex mutex_;
    double largest_ = 0;
};

TEST(Bake, EntersEachPhaseOnceAndReportsItsOwnFraction) {
    const SmallInputs inputs;
    for (const TransmittanceMethod method :
         {TransmittanceMethod::volume, TransmittanceMethod::trace, TransmittanceMethod::opacity_maps}) {
        Recorder progress;
        BakeRequest request = inputs.request();
        request.transmittance.method = method;
        BakeResult result = bake(request, 1, progress);
        write_result(result, inputs.folder / "out", progress);
        EXPECT_EQ(progress.phases, (std::vector<std::string>{"read_hair", "read_environment", "transmittance",
                                                             "reference", "irradiance", "write"}));
    }
}

TEST(Bake, MissingAndBrokenInputsAreBadInputThatNamesTheFile) {
    const SmallInputs inputs;
    std::ofstream(inputs.folder / "broken.hair") << "HAIR but not really";
    std::ofstream(inputs.folder / "broken.hdr") << "#?RADIANCE and nothing";
    for (const char* name : {"missing.hair", "broken.hair", "missing.hdr", "broken.hdr"}) {
        BakeRequest request = inputs.request();
        (std::string(name).ends_with("hair") ? request.hair : request.environment) = (inputs.folder / name).string();
        BakeProgress progress;
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
