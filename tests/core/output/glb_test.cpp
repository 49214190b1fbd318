// hair.glb, read back by tinygltf's loader and judged by Khronos' validator.
#include "core/output/glb_file.h"

#include <gtest/gtest.h>
#include <tiny_gltf.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/hair/tangents.h"
#include "tests/core/output/small_result.h"
#include "tests/support/run_program.h"
#include "tests/support/source_tree.h"
#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

using test_support::small_result;
using test_support::TemporaryFolder;

tinygltf::Model load(const std::filesystem::path& file) {
    tinygltf::Model model;
    std::string error, warning;
    EXPECT_TRUE(tinygltf::TinyGLTF().LoadBinaryFromFile(&model, &error, &warning, file.string()));
    EXPECT_EQ(error + warning, "");
    return model;
}

/// The values of an accessor, through its view's stride.
template <class T>
std::vector<T> values_of(const tinygltf::Model& model, int index, int component, int type) {
    const tinygltf::Accessor& accessor = model.accessors.at(index);
    const tinygltf::BufferView& view = model.bufferViews.at(accessor.bufferView);
    EXPECT_EQ(accessor.componentType, component);
    EXPECT_EQ(accessor.type, type);
    const int components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type));
    const int stride = accessor.ByteStride(view);
    std::vector<T> values(accessor.count * components);
    for (std::size_t i = 0; i < accessor.count; ++i)
        std::memcpy(&values[i * components],
                    &model.buffers.at(0).data.at(view.byteOffset + accessor.byteOffset + i * stride),
                    components * sizeof(T));
    return values;
}

std::vector<float> floats_of(const tinygltf::Model& model, const std::string& attribute, int type) {
    const auto& attributes = model.meshes.at(0).primitives.at(0).attributes;
    if (!attributes.contains(attribute)) return {};
    return values_of<float>(model, attributes.at(attribute), TINYGLTF_COMPONENT_TYPE_FLOAT, type);
}

/// What the validator found, of any severity.
nlohmann::json issues_of(const std::filesystem::path& file) {
    const auto run = test_support::run_program("node " + test_support::source_file("tests/npm/validate_gltf.mjs") +
                                               " " + file.string() + " 2>&1");
    EXPECT_EQ(run.exit_code, 0) << run.output << "(./dev test installs what this needs)";
    return run.exit_code ? nlohmann::json() : nlohmann::json::parse(run.output)["issues"]["messages"];
}

TEST(Glb, TinygltfFindsTheVerticesTheLinesAndA) {
    const TemporaryFolder folder;
    const BakeResult result = small_result();
    const WrittenFile file = write_glb(*result.hair, result.parts[0].arrays, result.request, folder / "");
    EXPECT_EQ(file.name, "hair.glb");
    EXPECT_EQ(file.bytes, std::filesystem::file_size(folder / "hair.glb"));
    const tinygltf::Model model = load(folder / "hair.glb");
    ASSERT_EQ(model.meshes.at(0).primitives.size(), 1u);
    const tinygltf::Primitive& primitive = model.meshes[0].primitives[0];
    EXPECT_EQ(primitive.mode, TINYGLTF_MODE_LINE);
    EXPECT_EQ(floats_of(model, "POSITION", TINYGLTF_TYPE_VEC3),
              (std::vector<float>{0, 0, 0, 0, 1, 0, 0, 2, 0, 1, 0, 0, 1, 1, 0}));
    EXPECT_EQ(model.accessors[primitive.attributes.at("POSITION")].minValues, (std::vector<double>{0, 0, 0}));
    EXPECT_EQ(model.accessors[primitive.attributes.at("POSITION")].maxValues, (std::vector<double>{1, 2, 0}));
    EXPECT_EQ(floats_of(model, "_TRANSMITTANCE", TINYGLTF_TYPE_SCALAR), (std::vector<float>{0, .25f, .5f, .75f, 1}));
    EXPECT_EQ(floats_of(model, "_TANGENT", TINYGLTF_TYPE_VEC3),
              (std::vector<float>{0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0}));
    // Strands of 3 and 2 vertices: each segment's two ends, no line from one strand to the next.
    EXPECT_EQ(
        values_of<std::uint32_t>(model, primitive.indices, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR),
        (std::vector<std::uint32_t>{0, 1, 1, 2, 3, 4}));
    EXPECT_EQ(primitive.attributes.size(), 3u);
    EXPECT_EQ(model.meshes[0].extras.Get("strands").GetNumberAsInt(), 2);
    EXPECT_EQ(issues_of(folder / "hair.glb"), nlohmann::json::array());
}

TEST(Glb, HoldsSphericalHarmonicsAndBentConesWhereTheBakeHasThem) {
    const TemporaryFolder folder;
    BakeResult result = small_result();
    std::vector<VertexArray>& arrays = test_support::transmittance_of(result).arrays;
    arrays.push_back(test_support::counted_array(transmittance_sh_kind(), 5, 9, 1));
    arrays.push_back(test_support::counted_array(bent_cone_kind(), 5, 4, -1));
    write_glb(*result.hair, result.parts[0].arrays, result.request, folder / "");
    const tinygltf::Model model = load(folder / "hair.glb");
    EXPECT_EQ(floats_of(model, "_BENT_CONE", TINYGLTF_TYPE_VEC4), arrays.back().values);
    for (int i = 0; i < 9; ++i) {
        const auto found = floats_of(model, "_TRANSMITTANCE_SH_" + std::to_string(i), TINYGLTF_TYPE_SCALAR);
        EXPECT_EQ(found, (std::vector<float>{float(i), float(9 + i), float(18 + i), float(27 + i), float(36 + i)}));
    }
    EXPECT_TRUE(floats_of(model, "_TRANSMITTANCE_SH_9", TINYGLTF_TYPE_SCALAR).empty());
    EXPECT_EQ(issues_of(folder / "hair.glb"), nlohmann::json::array());
}

TEST(Glb, IsValidForModelsWithoutSegmentsAndWithoutVertices) {
    const TemporaryFolder folder;
    BakeResult result = small_result();
    result.hair->strand_begin = {0, 1, 2, 3, 4, 5};
    write_glb(*result.hair, result.parts[0].arrays, result.request, folder / "");
    EXPECT_EQ(load(folder / "hair.glb").meshes.at(0).primitives.at(0).mode, TINYGLTF_MODE_POINTS);
    EXPECT_EQ(issues_of(folder / "hair.glb"), nlohmann::json::array());

    const TemporaryFolder empty;
    HairModel none;
    none.strand_begin = {0};
    write_glb(none, {}, BakeRequest{}, empty / "");
    const tinygltf::Model model = load(empty / "hair.glb");
    EXPECT_TRUE(model.meshes.empty());
    EXPECT_EQ(issues_of(empty / "hair.glb"), nlohmann::json::array());
}

TEST(Glb, BeyondFourGibibytesIsRefusedBeforeAnyMemoryIsTaken) {
    // 12 + 12 + 4 bytes a vertex and 8 a segment: 36 V - 8 S. (2^32 - 1 - 2^16) / 36 = 119.3 million.
    BakeRequest plain, full;
    plain.hair = full.hair = "a.hair";
    full.transmittance.sh_bands = 4;
    full.transmittance.bent_cone = true;
    EXPECT_NO_THROW(check_glb_size(119'000'000, 1, plain));
    EXPECT_NO_THROW(check_glb_size(37'000'000, 1, full));  // 116 bytes each
    for (const auto& [vertices, request] : {std::pair{std::uint64_t{120'000'000}, plain},
                                            {std::uint64_t{38'000'000}, full},
                                            {std::uint64_t{4'000'000'000}, plain}}) {
        try {
            check_glb_size(vertices, 1, request);
            ADD_FAILURE() << vertices;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::bad_input);
            EXPECT_EQ(error.field(), "outputs");
            for (const std::string& piece : {std::to_string(vertices), std::string("4294967295"), std::string("npy")})
                EXPECT_NE(std::string(error.what()).find(piece), std::string::npos) << error.what();
        }
    }
}

}  // namespace
}  // namespace hairbake
