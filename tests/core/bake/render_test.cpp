#include "core/render.h"

#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <utility>

#include "core/bake.h"
#include "core/base/digest.h"
#include "core/base/error.h"
#include "core/environment/image_file.h"
#include "core/render/camera_json.h"
#include "core/result_reader.h"
#include "tests/support/small_inputs.h"

namespace hairbake {
namespace {

using test_support::SmallInputs;

/// A result folder of the small inputs, and a request that shows it in a moment.
class RenderedResult : public testing::Test {
protected:
    RenderedResult() {
        BakeResult result = bake(inputs.request(), 0, progress);
        write_result(result, inputs.folder / "result", progress);
        request.result = (inputs.folder / "result").string();
        request.frame = {24, 24, 2, 1, Channel::beauty};
    }

    /// The kind of the error, and that its message names `name`.
    void expect_error(ErrorKind kind, const std::string& name) {
        try {
            render(request, 0, progress);
            ADD_FAILURE() << "rendered";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), kind) << error.what();
            EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
        }
    }

    void write(const std::string& name, const std::string& text) const {
        std::ofstream(inputs.folder / name, std::ios::binary) << text;
    }

    SmallInputs inputs;
    RenderRequest request;
    BakeProgress progress;
};

TEST_F(RenderedResult, IsTheSamePictureAsOfABakeInMemory) {
    // The .npy files hold the bake's floats to the last bit.
    RenderRequest direct = request;
    direct.result.reset();
    direct.bake = inputs.request();
    for (const ShadingMode mode : {ShadingMode::baked, ShadingMode::brute, ShadingMode::reference}) {
        request.mode = direct.mode = mode;
        EXPECT_TRUE(render(request, 0, progress).pixels == render(direct, 0, progress).pixels);
    }
}

TEST_F(RenderedResult, WithDirectionalTransmittanceAndAnOccluderIsTheSameAsOfABakeInMemory) {
    BakeRequest baked = inputs.request();
    baked.occluder = (inputs.folder / "samples" / "head.obj").string();
    baked.transmittance.sh_bands = 2;
    baked.transmittance.bent_cone = true;
    BakeResult result = bake(baked, 0, progress);
    write_result(result, inputs.folder / "directional", progress);
    request.result = (inputs.folder / "directional").string();
    request.mesh = baked.occluder;
    RenderRequest direct = request;
    direct.result.reset();
    direct.bake = baked;
    std::vector<std::vector<Vec3f>> pictures;
    for (const auto& [mode, kind] : {std::pair{ShadingMode::directional, Directional::sh},
                                     {ShadingMode::directional, Directional::bent_cone},
                                     {ShadingMode::reference, Directional::automatic}}) {
        request.mode = direct.mode = mode;
        request.directional = direct.directional = kind;
        pictures.push_back(render(request, 0, progress).pixels);
        EXPECT_TRUE(pictures.back() == render(direct, 0, progress).pixels);
    }
    EXPECT_FALSE(pictures[0] == pictures[1]);
    // The mode reference traces the occluder, so that it must be found.
    std::filesystem::rename(inputs.folder / "samples" / "head.obj", inputs.folder / "moved.obj");
    request.mesh.reset();
    expect_error(ErrorKind::usage, "--occluder");
    request.bake.occluder = (inputs.folder / "moved.obj").string();
    EXPECT_NO_THROW(render(request, 0, progress));
}

TEST_F(RenderedResult, NeedsNoEnvironmentWhenNothingShowsOrUsesIt) {
    std::filesystem::remove(inputs.folder / "samples" / "sky.hdr");
    expect_error(ErrorKind::usage, "--env");
    request.background = false;
    EXPECT_EQ(render(request, 0, progress).pixels.size(), 576u);
    request.mode = ShadingMode::brute;
    expect_error(ErrorKind::usage, "--env");
}

TEST_F(RenderedResult, TakesOnlyTheFilesThatItWasBakedFrom) {
    request.bake.environment = (inputs.folder / "samples" / "studio.hdr").string();
    expect_error(ErrorKind::bad_input, "studio.hdr");
    request.bake.environment.reset();
    SampleSettings other;
    other.vertices = 3000;
    other.seed = 2;
    other.map_width = 16;
    write_samples(inputs.folder / "other", other, progress);
    request.bake.hair = (inputs.folder / "other" / "groom.hair").string();
    expect_error(ErrorKind::bad_input, "groom.hair");
    request.bake.hair = (inputs.folder / "samples" / "groom.hair").string();
    EXPECT_NO_THROW(render(request, 0, progress));
}

TEST_F(RenderedResult, RefusesAChangedOrHostileFolder) {
    const auto manifest = inputs.folder / "result" / "manifest.json";
    std::ifstream stream(manifest);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string changed = text;
        const auto at = changed.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        if (at != std::string::npos) changed.replace(at, from.size(), to);
        write("result/manifest.json", changed);
    };
    with("\"face_size\": 4", "\"face_size\": 5");
    expect_error(ErrorKind::bad_input, "allowed is [6, 5, 5, 3]");
    with("\"face_size\": 4", "\"face_size\": \"4\"");
    expect_error(ErrorKind::bad_input, "manifest.json");
    with("hairbake result", "other result");
    expect_error(ErrorKind::bad_input, "manifest.json");
    write("result/manifest.json", text.substr(0, text.size() / 2));
    expect_error(ErrorKind::bad_input, "manifest.json");
    write("result/manifest.json", text);
    std::ofstream(inputs.folder / "result" / "diffuse.npy", std::ios::app) << "x";
    expect_error(ErrorKind::bad_input, "diffuse.npy");
    std::filesystem::remove(manifest);
    expect_error(ErrorKind::bad_input, "manifest.json");
}

TEST_F(RenderedResult, SettingsOutOfRangeAreUsageErrors) {
    const auto refused = [&](const std::string& name, const std::function<void(RenderRequest&)>& change) {
        const RenderRequest good = request;
        change(request);
        expect_error(ErrorKind::usage, name);
        request = good;
    };
    refused("samples", [](RenderRequest& r) { r.frame.samples = 0; });
    refused("width", [](RenderRequest& r) { r.frame.width = 20000; });
    refused("albedo", [](RenderRequest& r) { r.look.albedo = 1.1; });
    refused("specular", [](RenderRequest& r) { r.look.specular = -1; });
    refused("color", [](RenderRequest& r) { r.look.color[1] = 2; });
    refused("light_samples", [](RenderRequest& r) { r.light_samples = 0; });
    refused("sh_bands", [](RenderRequest& r) { r.mode = ShadingMode::directional; });
    refused("--hair", [](RenderRequest& r) { r.result.reset(); });
    refused("fov", [](RenderRequest& r) { r.orbit.fov_deg = 200; });
}

TEST_F(RenderedResult, IsWrittenAsExrToTheLastBitAndAsPng) {
    const RenderedPicture picture = render(request, 0, progress);
    write_picture(picture, 0, inputs.folder / "a.exr");
    write_picture(picture, 0, inputs.folder / "a.exr");  // replaces
    const ImageFile read = read_image_file(
        inputs.folder / "a.exr", [](int, int) { return std::string(); }, progress);
    EXPECT_EQ(read.width, 24);
    EXPECT_TRUE(read.pixels == picture.pixels);
    write_picture(picture, automatic_exposure(picture), inputs.folder / "a.png");
    EXPECT_GT(std::filesystem::file_size(inputs.folder / "a.png"), 100u);
    EXPECT_THROW(write_picture(picture, 0, inputs.folder / "a.jpg"), Error);
}

TEST(CameraFile, HoldsAnEyeOrAnOrbit) {
    const test_support::TemporaryFolder folder;
    const auto read = [&](const std::string& text) {
        std::ofstream(folder / "camera.json") << text;
        return read_camera(folder / "camera.json", {-1, -1, -1}, {1, 1, 1}, 1);
    };
    EXPECT_EQ(read(R"({"eye": [1, 2, 3], "target": [0, 0, 0], "fov_deg": 90})").eye, Vec3d(1, 2, 3));
    EXPECT_NEAR(read(R"({"azimuth_deg": 90, "distance": 4})").eye.x, 4, 1e-12);
    for (const char* bad : {"[]", "{", R"({"eye": [1, 2], "target": [0, 0, 0]})", R"({"azimut": 3})",
                            R"({"eye": [0, 0, 0], "target": [0, 0, 0]})", R"({"distance": "far"})"})
        EXPECT_THROW(read(bad), Error) << bad;
}

}  // namespace
}  // namespace hairbake
