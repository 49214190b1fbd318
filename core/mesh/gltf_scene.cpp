#include "core/mesh/gltf_scene.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/base/short_number.h"
#include "core/mesh/gltf_accessor.h"
#include "core/mesh/gltf_transform.h"
#include "core/mesh/mesh_reader.h"

namespace hairbake {
namespace {

constexpr std::size_t most_corners = 200'000'000;  ///< of all instances: more than 256 MiB of triangles

GltfTransform transform_of(const tinygltf::Node& node) {
    GltfTransform t;
    if (node.matrix.size() == 16) {  // columns
        const auto column = [&](std::size_t c) {
            return Vec3d(node.matrix[4 * c], node.matrix[4 * c + 1], node.matrix[4 * c + 2]);
        };
        return {{column(0), column(1), column(2)}, column(3)};
    }
    if (node.translation.size() == 3) t.origin = {node.translation[0], node.translation[1], node.translation[2]};
    if (node.rotation.size() == 4) {
        const double x = node.rotation[0], y = node.rotation[1], z = node.rotation[2], w = node.rotation[3];
        t.axes = {Vec3d(1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)),
                  Vec3d(2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)),
                  Vec3d(2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y))};
    }
    if (node.scale.size() == 3)
        for (int axis = 0; axis < 3; ++axis)
            t.axes[static_cast<std::size_t>(axis)] *= node.scale[static_cast<std::size_t>(axis)];
    return t;
}

class SceneReader {
public:
    SceneReader(const tinygltf::Model& model, const std::string& name)
        : model_(model), name_(name), seen_(model.nodes.size()) {}

    PolygonFile read(const char* format) {
        struct Item {
            int node;
            GltfTransform parent;
        };
        std::vector<Item> stack;
        const auto push = [&](const std::vector<int>& nodes, const GltfTransform& parent) {
            for (auto node = nodes.rbegin(); node != nodes.rend(); ++node) stack.push_back({*node, parent});
        };
        push(roots(), {});
        while (!stack.empty()) {
            const Item item = stack.back();
            stack.pop_back();
            const tinygltf::Node& node = take(item.node);
            const GltfTransform transform = item.parent.after(transform_of(node));
            // The specification lets a skin's joints move its vertices, and not the node.
            if (node.mesh >= 0) add_mesh(node, node.skin >= 0 ? GltfTransform() : transform);
            push(node.children, transform);
        }
        if (mesh_.face_end.empty()) refuse_mesh(name_, "the scene shows no triangle; at least one is needed");
        return {std::move(mesh_), format, warnings()};
    }

private:
    /// Positions [first, first + count) of the mesh.
    struct Range {
        std::size_t first, count;
    };

    std::vector<int> roots() const {
        if (!model_.scenes.empty()) {
            const auto scene = static_cast<std::size_t>(std::max(model_.defaultScene, 0));
            if (scene >= model_.scenes.size())
                refuse_mesh(name_, "the default scene " + std::to_string(scene) + " does not exist");
            return model_.scenes[scene].nodes;
        }
        std::vector<bool> child(model_.nodes.size());
        for (const tinygltf::Node& node : model_.nodes)
            for (const int index : node.children)
                if (index >= 0 && static_cast<std::size_t>(index) < child.size())
                    child[static_cast<std::size_t>(index)] = true;
        std::vector<int> list;
        for (std::size_t i = 0; i < child.size(); ++i)
            if (!child[i]) list.push_back(static_cast<int>(i));
        return list;
    }

    const tinygltf::Node& take(int index) {
        const auto i = static_cast<std::size_t>(index);
        if (index < 0 || i >= model_.nodes.size())
            refuse_mesh(name_, "node " + std::to_string(index) + " does not exist");
        if (seen_[i]) refuse_mesh(name_, "node " + std::to_string(index) + " has two parents; allowed is one");
        seen_[i] = true;
        return model_.nodes[i];
    }

    void add_mesh(const tinygltf::Node& node, const GltfTransform& transform) {
        if (static_cast<std::size_t>(node.mesh) >= model_.meshes.size())
            refuse_mesh(name_, "mesh " + std::to_string(node.mesh) + " does not exist");
        const tinygltf::Mesh& mesh = model_.meshes[static_cast<std::size_t>(node.mesh)];
        skinned_ += node.skin >= 0;
        std::map<std::pair<int, int>, Range> added;  // accessors whose positions are there already
        bool morphed = false;
        for (const tinygltf::Primitive& primitive : mesh.primitives) {
            const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
            const auto position = primitive.attributes.find("POSITION");
            if (mode < TINYGLTF_MODE_TRIANGLES || position == primitive.attributes.end()) {
                ++left_out_;
                continue;
            }
            morphed = morphed || !primitive.targets.empty();
            const auto normal = primitive.attributes.find("NORMAL");
            const std::pair key(position->second, normal == primitive.attributes.end() ? -1 : normal->second);
            auto found = added.find(key);
            if (found == added.end()) found = added.emplace(key, add_positions(key, transform)).first;
            add_triangles(primitive, mode, found->second, transform.determinant() < 0);
        }
        morphed_ += morphed;
    }

    Range add_positions(const std::pair<int, int>& accessors, const GltfTransform& transform) {
        const std::size_t first = mesh_.positions.size();
        const std::vector<Vec3d> positions = gltf_vectors(model_, accessors.first, name_);
        if (first + positions.size() > most_corners) refuse_count();
        for (const Vec3d& p : positions) {
            const Vec3d moved = transform.point(p);
            for (int axis = 0; axis < 3; ++axis)
                if (!(std::abs(moved[axis]) <= farthest_coordinate))
                    refuse_mesh(name_, "position " + std::to_string(&p - positions.data()) + " of accessor " +
                                           std::to_string(accessors.first) + " has the coordinate " +
                                           short_number(moved[axis]) + "; allowed are numbers from -1e18 to 1e18");
            mesh_.positions.emplace_back(moved);
        }
        mesh_.normals.resize(mesh_.positions.size());
        if (accessors.second < 0) return {first, positions.size()};
        const std::vector<Vec3d> normals = gltf_vectors(model_, accessors.second, name_);
        if (normals.size() != positions.size())
            refuse_mesh(name_, "accessor " + std::to_string(accessors.second) + " has " +
                                   std::to_string(normals.size()) + " normals for " + std::to_string(positions.size()) +
                                   " positions");
        for (std::size_t i = 0; i < normals.size(); ++i) {
            const Vec3d moved = transform.normal(normals[i]);
            const double size = length(moved);
            if (size > 0 && std::isfinite(size)) mesh_.normals[first + i] = Vec3f(moved / size);
        }
        return {first, positions.size()};
    }

    /// `mirrored`: the transform turns the triangles round; here they are turned back.
    void add_triangles(const tinygltf::Primitive& primitive, int mode, const Range& range, bool mirrored) {
        std::vector<std::uint32_t> indices;
        if (primitive.indices >= 0) {
            indices = gltf_indices(model_, primitive.indices, name_);
        } else {
            const int accessor = primitive.attributes.at("POSITION");
            indices.resize(model_.accessors[static_cast<std::size_t>(accessor)].count);
            for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = static_cast<std::uint32_t>(i);
        }
        for (const std::uint32_t i : indices)
            if (i >= range.count)
                refuse_mesh(name_, "accessor " + std::to_string(primitive.indices) + " names position " +
                                       std::to_string(i) + "; there are " + std::to_string(range.count) +
                                       ", the first is 0");
        const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
            for (const std::size_t k : {a, mirrored ? c : b, mirrored ? b : c})
                mesh_.corners.push_back(static_cast<std::uint32_t>(range.first) + indices[k]);
            mesh_.end_face();
        };
        if (mesh_.corners.size() + 3 * indices.size() > most_corners) refuse_count();
        if (mode == TINYGLTF_MODE_TRIANGLES)
            for (std::size_t k = 2; k < indices.size(); k += 3) add(k - 2, k - 1, k);
        else
            for (std::size_t k = 2; k < indices.size(); ++k) {
                if (mode == TINYGLTF_MODE_TRIANGLE_FAN)
                    add(0, k - 1, k);
                else
                    k % 2 == 0 ? add(k - 2, k - 1, k) : add(k - 2, k, k - 1);
            }
    }

    [[noreturn]] void refuse_count() const {
        refuse_mesh(name_, "its nodes show more than " + std::to_string(most_corners) + " corners of triangles");
    }

    std::vector<std::string> warnings() const {
        std::vector<std::string> list;
        const auto add = [&](std::size_t count, const char* what) {
            if (count > 0) list.push_back(std::to_string(count) + what);
        };
        add(skinned_,
            " of its meshes have a skin, which is not applied: they are taken as they were bound; export the pose");
        add(morphed_, " of its meshes have morph targets, which are not applied: their base shapes are taken");
        add(left_out_, " of its primitives are points or lines, or have no positions; they are left out");
        return list;
    }

    const tinygltf::Model& model_;
    const std::string& name_;
    std::vector<bool> seen_;
    PolygonMesh mesh_;
    std::size_t skinned_ = 0, morphed_ = 0, left_out_ = 0;
};

}  // namespace

PolygonFile read_gltf_scene(const tinygltf::Model& model, const std::string& name, const char* format) {
    return SceneReader(model, name).read(format);
}

}  // namespace hairbake
