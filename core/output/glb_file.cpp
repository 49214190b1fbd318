#include "core/output/glb_file.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <span>
#include <sstream>

#include "core/base/bounds.h"
#include "core/base/error.h"
#include "core/hair/tangents.h"
#include "core/output/format_table.h"
#include "core/output/sink_buffer.h"
#include "core/output/versions.h"

namespace hairbake {
namespace {

/// Fills a glTF model whose one buffer holds everything.
class GltfBuilder {
public:
    GltfBuilder() { gltf.buffers.emplace_back(); }

    /// The values of the view are records of `stride` bytes; 0 for tightly packed values.
    int add_view(std::span<const std::byte> bytes, int target, std::size_t stride = 0) {
        std::vector<unsigned char>& data = gltf.buffers[0].data;
        tinygltf::BufferView view;
        view.buffer = 0;
        view.byteOffset = data.size();
        view.byteLength = bytes.size();
        view.byteStride = stride;
        view.target = target;
        const auto* begin = reinterpret_cast<const unsigned char*>(bytes.data());
        data.insert(data.end(), begin, begin + bytes.size());
        gltf.bufferViews.push_back(view);
        return static_cast<int>(gltf.bufferViews.size()) - 1;
    }

    int add_accessor(int view, int component, int type, std::size_t count, std::size_t offset = 0) {
        tinygltf::Accessor accessor;
        accessor.bufferView = view;
        accessor.byteOffset = offset;
        accessor.componentType = component;
        accessor.type = type;
        accessor.count = count;
        gltf.accessors.push_back(accessor);
        return static_cast<int>(gltf.accessors.size()) - 1;
    }

    /// One float attribute per vertex, tightly packed.
    template <class T>
    int add_attribute(const std::vector<T>& values, int type, std::size_t count) {
        return add_accessor(add_view(std::as_bytes(std::span(values)), TINYGLTF_TARGET_ARRAY_BUFFER),
                            TINYGLTF_COMPONENT_TYPE_FLOAT, type, count);
    }

    tinygltf::Model gltf;
};

void set_bounds(const std::vector<Vec3f>& positions, tinygltf::Accessor& accessor) {
    const auto [low, high] = bounds_of(positions);
    accessor.minValues = {low.x, low.y, low.z};
    accessor.maxValues = {high.x, high.y, high.z};
}

/// The two ends of each segment, strand by strand.
std::vector<std::array<std::uint32_t, 2>> segment_indices(const HairModel& model) {
    std::vector<std::array<std::uint32_t, 2>> pairs;
    pairs.reserve(model.vertex_count() - model.strand_count());
    for (std::size_t s = 0; s < model.strand_count(); ++s)
        for (std::uint32_t i = model.strand_begin[s]; i + 1 < model.strand_begin[s + 1]; ++i)
            pairs.push_back({i, i + 1});
    return pairs;
}

/// "_BENT_CONE" of the array "bent_cone".
std::string attribute_name(const ArrayKind& kind) {
    std::string name = "_";
    for (const char c : kind.name) name += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return name;
}

/// One attribute a vector of up to four components; else one a component, as glTF has no longer vectors.
void add_array(const VertexArray& array, GltfBuilder& builder, std::map<std::string, int>& attributes) {
    const std::string name = attribute_name(*array.kind);
    if (array.kind->layout != ArrayLayout::coefficients && array.components <= 4) {
        constexpr int types[] = {TINYGLTF_TYPE_SCALAR, TINYGLTF_TYPE_VEC2, TINYGLTF_TYPE_VEC3, TINYGLTF_TYPE_VEC4};
        attributes[name] = builder.add_attribute(array.values, types[array.components - 1], array.rows());
        return;
    }
    const int view = builder.add_view(std::as_bytes(std::span(array.values)), TINYGLTF_TARGET_ARRAY_BUFFER,
                                      array.components * sizeof(float));
    for (std::size_t i = 0; i < array.components; ++i)
        attributes[name + "_" + std::to_string(i)] = builder.add_accessor(
            view, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_SCALAR, array.rows(), i * sizeof(float));
}

tinygltf::Primitive make_primitive(const HairModel& model, std::span<const VertexArray> arrays, GltfBuilder& builder) {
    const std::size_t vertices = model.vertex_count();
    tinygltf::Primitive primitive;
    auto& attributes = primitive.attributes;
    attributes["POSITION"] = builder.add_attribute(model.positions, TINYGLTF_TYPE_VEC3, vertices);
    set_bounds(model.positions, builder.gltf.accessors.back());
    attributes["_TANGENT"] = builder.add_attribute(vertex_tangents(model), TINYGLTF_TYPE_VEC3, vertices);
    for (const VertexArray& array : arrays)
        if (array.kind->owner == ArrayOwner::hair) add_array(array, builder, attributes);

    primitive.mode = TINYGLTF_MODE_POINTS;
    if (const auto pairs = segment_indices(model); !pairs.empty()) {
        primitive.mode = TINYGLTF_MODE_LINE;
        const int view = builder.add_view(std::as_bytes(std::span(pairs)), TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
        primitive.indices =
            builder.add_accessor(view, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR, 2 * pairs.size());
    }
    return primitive;
}

tinygltf::Value make_extras(const HairModel& model) {
    return tinygltf::Value(tinygltf::Value::Object{
        {"strands", tinygltf::Value(static_cast<double>(model.strand_count()))},
        {"units", tinygltf::Value(std::string("the model's own, not scaled to metres"))},
        {"frame", tinygltf::Value(std::string("right-handed, Y up; tangents from root to tip"))}});
}

tinygltf::Model make_gltf(const HairModel& model, std::span<const VertexArray> arrays) {
    GltfBuilder builder;
    tinygltf::Model& gltf = builder.gltf;
    gltf.asset.version = "2.0";
    gltf.asset.generator = "hairbake " + version();
    gltf.defaultScene = 0;
    gltf.scenes.emplace_back();
    gltf.scenes[0].name = "hair";  // tinygltf writes null for a scene without any member
    if (model.vertex_count() == 0) {
        gltf.buffers.clear();
        return gltf;
    }
    tinygltf::Mesh mesh;
    mesh.name = "hair";
    mesh.primitives.push_back(make_primitive(model, arrays, builder));
    mesh.extras = make_extras(model);
    gltf.meshes.push_back(mesh);
    tinygltf::Node node;
    node.name = "hair";
    node.mesh = 0;
    gltf.nodes.push_back(node);
    gltf.scenes[0].nodes = {0};
    return gltf;
}

}  // namespace

void check_glb_size(std::uint64_t vertices, std::uint64_t strands, const BakeRequest& request) {
    constexpr std::uint64_t limit = 0xFFFFFFFF, json = 1 << 16;  // the JSON in front takes a few thousand bytes
    std::uint64_t per_vertex = 12 + 12;                          // position and tangent
    for (const ArrayKind& kind : array_kinds())
        if (kind.owner == ArrayOwner::hair) per_vertex += sizeof(float) * kind.components(request);
    const std::uint64_t bytes = vertices * per_vertex + (vertices - strands) * 8;
    if (bytes + json <= limit) return;
    std::ostringstream text;
    text << "hair.glb of " << vertices << " vertices would hold " << bytes << " bytes; the format ends at " << limit
         << ". Leave glb out of the outputs: npy and raw have no such limit";
    throw Error(ErrorKind::bad_input, text.str(), "outputs");
}

WrittenFile write_glb(const HairModel& model, std::span<const VertexArray> arrays, const BakeRequest& request,
                      const std::filesystem::path& folder) {
    check_glb_size(model.vertex_count(), model.strand_count(), request);
    FileSink sink(folder / "hair.glb");
    SinkBuffer buffer(sink);
    std::ostream stream(&buffer);
    stream.exceptions(std::ios::badbit);  // makes the stream rethrow what the sink throws
    const tinygltf::Model gltf = make_gltf(model, arrays);
    if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&gltf, stream, false, true))
        throw Error(ErrorKind::internal, "hair.glb: tinygltf could not write it");
    WrittenFile written = sink.finish();
    written.shape = {model.vertex_count()};
    written.content = "lines with POSITION, _TANGENT, _TRANSMITTANCE";
    return written;
}

std::vector<WrittenFile> write_glb_lines(const OutputContext& context, const StagePart& part) {
    context.progress.check();
    if (!find_array(part.arrays, average_transmittance_kind())) return {};
    return {write_glb(*context.result.hair, part.arrays, context.result.request, context.folder)};
}

}  // namespace hairbake
