#include "core/mesh/gltf_accessor.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "core/mesh/mesh_reader.h"

namespace hairbake {
namespace {

/// The bytes of an accessor, checked against its buffer.
struct GltfBytes {
    const unsigned char* data = nullptr;
    std::size_t count = 0, stride = 0;
    int component = 0;
    bool normalized = false;
};

[[noreturn]] void refuse(const std::string& name, int index, const std::string& what) {
    refuse_mesh(name, "accessor " + std::to_string(index) + " " + what);
}

GltfBytes bytes_of(const tinygltf::Model& model, int index, int type, const std::string& name) {
    if (index < 0 || static_cast<std::size_t>(index) >= model.accessors.size())
        refuse(name, index, "does not exist; the file has " + std::to_string(model.accessors.size()));
    const tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(index)];
    if (accessor.sparse.isSparse) refuse(name, index, "is sparse, which is not read; export the mesh without it");
    if (accessor.type != type)
        refuse(name, index, std::string("holds no ") + (type == TINYGLTF_TYPE_VEC3 ? "vectors of three" : "scalars"));
    const int component_size = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType));
    if (component_size <= 0) refuse(name, index, "has no known type of component");
    const auto size = static_cast<std::size_t>(component_size) * (type == TINYGLTF_TYPE_VEC3 ? 3 : 1);
    if (accessor.bufferView < 0 || static_cast<std::size_t>(accessor.bufferView) >= model.bufferViews.size())
        refuse(name, index, "has no buffer view");
    const tinygltf::BufferView& view = model.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
    if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= model.buffers.size())
        refuse(name, index, "lies in a buffer that does not exist");
    const std::vector<unsigned char>& data = model.buffers[static_cast<std::size_t>(view.buffer)].data;
    const std::size_t stride = view.byteStride == 0 ? size : view.byteStride;
    const bool view_fits = view.byteOffset <= data.size() && view.byteLength <= data.size() - view.byteOffset;
    const bool values_fit =
        view_fits && accessor.byteOffset <= view.byteLength && stride >= size &&
        (accessor.count == 0 || (size <= view.byteLength - accessor.byteOffset &&
                                 accessor.count - 1 <= (view.byteLength - accessor.byteOffset - size) / stride));
    if (!values_fit)
        refuse(name, index,
               "has " + std::to_string(accessor.count) + " values; they do not fit into its buffer of " +
                   std::to_string(data.size()) + " bytes");
    return {data.data() + view.byteOffset + accessor.byteOffset, accessor.count, stride, accessor.componentType,
            accessor.normalized};
}

template <class T>
double number_at(const unsigned char* at, bool normalized) {
    T value;
    std::memcpy(&value, at, sizeof value);
    const auto number = static_cast<double>(value);
    return normalized ? std::max(number / static_cast<double>(std::numeric_limits<T>::max()), -1.0) : number;
}

double number_at(const unsigned char* at, int component, bool normalized) {
    switch (component) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            return number_at<std::int8_t>(at, normalized);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return number_at<std::uint8_t>(at, normalized);
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            return number_at<std::int16_t>(at, normalized);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return number_at<std::uint16_t>(at, normalized);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return number_at<std::uint32_t>(at, false);
        default:
            return number_at<float>(at, false);
    }
}

}  // namespace

std::vector<Vec3d> gltf_vectors(const tinygltf::Model& model, int index, const std::string& name) {
    const GltfBytes bytes = bytes_of(model, index, TINYGLTF_TYPE_VEC3, name);
    const bool known =
        bytes.component >= TINYGLTF_COMPONENT_TYPE_BYTE && bytes.component <= TINYGLTF_COMPONENT_TYPE_FLOAT &&
        bytes.component != TINYGLTF_COMPONENT_TYPE_INT && bytes.component != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    if (!known) refuse(name, index, "has vectors that are neither floats nor quantized integers");
    const auto size =
        static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(bytes.component)));
    std::vector<Vec3d> values(bytes.count);
    for (std::size_t i = 0; i < bytes.count; ++i)
        for (int axis = 0; axis < 3; ++axis)
            values[i][axis] = number_at(bytes.data + i * bytes.stride + static_cast<std::size_t>(axis) * size,
                                        bytes.component, bytes.normalized);
    return values;
}

std::vector<std::uint32_t> gltf_indices(const tinygltf::Model& model, int index, const std::string& name) {
    const GltfBytes bytes = bytes_of(model, index, TINYGLTF_TYPE_SCALAR, name);
    const bool known = bytes.component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                       bytes.component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                       bytes.component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    if (!known) refuse(name, index, "has indices that are no unsigned integers");
    std::vector<std::uint32_t> values(bytes.count);
    for (std::size_t i = 0; i < bytes.count; ++i)
        values[i] = static_cast<std::uint32_t>(number_at(bytes.data + i * bytes.stride, bytes.component, false));
    return values;
}

}  // namespace hairbake
