// Checks of headers say what the reading says, and check_bake() finds what can be known before a bake.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <fstream>

#include "core/bake.h"
#include "core/environment/environment_reader.h"
#include "core/hair/hair_file.h"
#include "core/mesh/mesh_file.h"
#include "tests/support/hair_bytes.h"
#include "tests/support/small_inputs.h"

namespace hairbake {
namespace {

namespace fs = std::filesystem;
using test_support::SmallInputs;

template <class Body>
std::string words_of(const Body& body) {
    try {
        body();
    } catch (const Error& error) {
        return error.what();
    }
    return "nothing was thrown";
}

void write(const fs::path& file, const std::string& bytes) { std::ofstream(file, std::ios::binary) << bytes; }

TEST(HeaderChecks, SayTheWordsOfTheReading) {
    const SmallInputs inputs;
    const fs::path folder = inputs.folder / "broken";
    fs::create_directories(folder / "folder");
    write(folder / "empty", "");
    write(folder / "text", "no file of any kind");
    write(folder / "short.hair", "HAIR, but no more");
    write(folder / "short.tfx", std::string("\0\0\x80\x40", 4) + "version 4 alone");
    write(folder / "square.pfm", "PF\n2 2\n-1.0\n" + std::string(48, '\0'));
    write(folder / "cut.pfm", "PF\n8 4\n-1.0\n");
    write(folder / "bare.hdr", "#?RADIANCE\n");
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);  // opening it would wait for a writer
    Progress progress;
    for (const char* name : {"missing", "empty", "text", "short.hair", "short.tfx", "square.pfm", "cut.pfm", "bare.hdr",
                             "folder", "pipe"}) {
        const fs::path file = folder / name;
        const std::string hair = words_of([&] { check_groom(file); });
        EXPECT_EQ(hair, words_of([&] { read_groom(file); }));
        EXPECT_NE(hair.find(name), std::string::npos) << hair;
        const std::string sky = words_of([&] { check_environment(file, {}); });
        EXPECT_EQ(sky, words_of([&] { read_environment(file, {}, progress); }));
        EXPECT_NE(sky.find(name), std::string::npos) << sky;
    }
    for (const char* name : {"missing", "folder", "pipe"}) {
        const std::string mesh = words_of([&] { check_mesh(folder / name); });
        EXPECT_EQ(mesh, words_of([&] { read_mesh(folder / name); }));
        EXPECT_NE(mesh.find(name), std::string::npos) << mesh;
    }
}

TEST(HeaderChecks, FindFacesThatDisagree) {
    const SmallInputs inputs;
    const fs::path folder = inputs.folder / "faces";
    fs::create_directories(folder);
    Progress progress;
    for (const std::string face : {"px", "nx", "py", "ny", "pz", "nz"}) {
        const std::string size = face == "pz" ? "4 4" : "2 2";
        write(folder / (face + ".pfm"), "PF\n" + size + "\n-1.0\n" + std::string(face == "pz" ? 192 : 48, '\0'));
    }
    const std::string words = words_of([&] { check_environment(folder, {}); });
    EXPECT_EQ(words, words_of([&] { read_environment(folder, {}, progress); }));
    EXPECT_NE(words.find("pz.pfm: the size is 4 x 4"), std::string::npos) << words;
    EnvironmentSettings cross;
    cross.layout = EnvironmentLayout::horizontal_cross;
    EXPECT_EQ(words_of([&] { check_environment(folder, cross); }),
              words_of([&] { read_environment(folder, cross, progress); }));
}

TEST(HeaderChecks, LetGoodFilesPass) {
    const SmallInputs inputs;
    EXPECT_NO_THROW(check_groom(*inputs.request().hair));
    EXPECT_NO_THROW(check_mesh(inputs.folder / "samples" / "head.obj"));
    EXPECT_NO_THROW(check_environment(*inputs.request().environment, {}));
}

TEST(CheckBake, ProvesThatTheFolderCanBeWrittenAndLeavesNothing) {
    const SmallInputs inputs;
    EXPECT_NO_THROW(check_bake(inputs.request(), inputs.folder / "a" / "b" / "out"));
    EXPECT_FALSE(fs::exists(inputs.folder / "a"));
    write(inputs.folder / "file", "");
    const fs::path below_a_file = inputs.folder / "file" / "out";
    const std::string words = words_of([&] { check_bake(inputs.request(), below_a_file); });
    EXPECT_NE(words.find(below_a_file.string() + " cannot be written"), std::string::npos) << words;
    const std::string proc = words_of([&] { check_bake(inputs.request(), "/proc"); });
    EXPECT_NE(proc.find("mount point"), std::string::npos) << proc;
    const fs::path long_name = inputs.folder / std::string(300, 'n');
    const std::string too_long = words_of([&] { check_bake(inputs.request(), long_name); });
    EXPECT_NE(too_long.find(std::string(300, 'n')), std::string::npos) << too_long;
}

TEST(CheckBake, RefusesEveryInputInTheResultFolder) {
    const SmallInputs inputs;
    const fs::path out = inputs.folder / "out";
    BakeProgress progress;
    BakeResult result = bake(inputs.request(), 2, progress);
    write_result(result, out, progress);
    BakeRequest request = inputs.request();
    request.hair = (out / "transmittance.hair").string();
    const auto words = [&](const BakeRequest& asked) { return words_of([&] { check_bake(asked, out); }); };
    EXPECT_NE(words(request).find("hair is " + *request.hair + ", which lies in the result folder"), std::string::npos)
        << words(request);
    // write_result() refuses by itself, too.
    BakeResult again = bake(request, 2, progress);
    EXPECT_NE(words_of([&] { write_result(again, out, progress); }).find("lies in the result folder"),
              std::string::npos);
    EXPECT_TRUE(fs::exists(*request.hair));
    // Relatives: a link to it, the environment, meshes, a folder and a pattern of faces, a detour.
    fs::create_symlink(*request.hair, inputs.folder / "link.hair");
    request.hair = (inputs.folder / "link.hair").string();
    EXPECT_NE(words(request).find("link.hair"), std::string::npos) << words(request);
    request = inputs.request();
    for (const fs::path& sky : {out / "diffuse_latlong.exr", out, out / "diffuse_{face}.exr"}) {
        request.environment = sky.string();
        EXPECT_NE(words(request).find("environment is " + sky.string()), std::string::npos) << words(request);
    }
    request = inputs.request();
    request.occluder = (out / ".." / "out" / "preview.png").string();
    EXPECT_NE(words(request).find("occluder is "), std::string::npos) << words(request);
    request.occluder.reset();
    request.receiver = (out / "preview.png").string();
    EXPECT_NE(words(request).find("receiver is "), std::string::npos) << words(request);
    request.receiver.reset();
    EXPECT_EQ(words(request), "nothing was thrown");
}

TEST(Bake, TellsThatTheFilesTransparencyIsNotUsed) {
    const SmallInputs inputs;
    BakeRequest request = inputs.request();
    request.environment.reset();
    using namespace test_support;
    const HairBytes file = make_hair_bytes(kSegments | kPoints | kThickness | kTransparency, {3, 4});
    std::ofstream(inputs.folder / "clear.hair", std::ios::binary)
        .write(reinterpret_cast<const char*>(file.bytes.data()), static_cast<std::streamsize>(file.bytes.size()));
    request.hair = (inputs.folder / "clear.hair").string();
    request.strand.width = 0.01;
    const auto told = [&] {
        BakeProgress progress;
        const BakeResult result = bake(request, 2, progress);
        return std::any_of(result.warnings.begin(), result.warnings.end(), [](const std::string& warning) {
            return warning.find("transparency") != std::string::npos;
        });
    };
    EXPECT_TRUE(told());
    request.strand.opacity = 0.5;  // chosen by the person
    EXPECT_FALSE(told());
    request.strand.opacity = 1;
    request.strand.opacity_from_file = true;
    EXPECT_FALSE(told());
}

}  // namespace
}  // namespace hairbake
