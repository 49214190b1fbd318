#include "core/result_reader.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "core/base/digest.h"
#include "core/base/error.h"
#include "core/base/json_reason.h"
#include "core/output/manifest.h"
#include "core/output/npy.h"
#include "core/request/request_json.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

[[noreturn]] void refuse(const fs::path& file, const std::string& what) {
    throw Error(ErrorKind::bad_input, file.string() + " " + what);
}

Json read_manifest(const fs::path& file) {
    Json manifest = Json::parse(read_manifest_text(file), nullptr, false);
    if (!manifest.is_object() || manifest.value("format", Json()) != "hairbake result")
        refuse(file, "is not a manifest of hairbake");
    return manifest;
}

/// Files of a result by name, read only when they are what the manifest says.
class ResultFiles {
public:
    ResultFiles(const fs::path& folder, const Json& manifest) : folder_(folder) {
        for (const Json& entry : manifest.at("files"))
            digests_[entry.at("name").get<std::string>()] = entry.at("sha256").get<std::string>();
    }

    std::string digest(const std::string& name) const {
        const auto found = digests_.find(name);
        return found == digests_.end() ? std::string() : found->second;
    }

    /// An empty shape where the result has no such file.
    NpyArray array(const std::string& name) const {
        const fs::path file = folder_ / name;
        if (digest(name).empty()) return {};
        if (digest_of_file(file) != digest(name))
            refuse(file, "is not the file that the manifest names: it has changed");
        NpyArray array = read_npy(file);
        for (std::size_t i = 0; i < array.values.size(); ++i)
            if (!std::isfinite(array.values[i])) refuse(file, "is not finite at value " + std::to_string(i));
        return array;
    }

    fs::path path(const std::string& name) const { return folder_ / name; }

private:
    fs::path folder_;
    std::map<std::string, std::string> digests_;
};

void expect_shape(const fs::path& file, const std::vector<std::size_t>& found,
                  const std::vector<std::size_t>& allowed) {
    if (found != allowed) refuse(file, "has the shape " + shape_text(found) + "; allowed is " + shape_text(allowed));
}

void read_arrays(const ResultFiles& files, StoredResult& result) {
    std::map<ArrayOwner, std::size_t> rows;  // the same for all arrays of an owner
    for (const ArrayKind& kind : array_kinds()) {
        const std::string name = std::string(kind.name) + ".npy";
        NpyArray read = files.array(name);
        if (read.shape.empty()) continue;
        VertexArray array{&kind, std::max<std::size_t>(1, kind.components(result.request)), std::move(read.values)};
        expect_shape(files.path(name), read.shape, array.shape());
        if (rows.try_emplace(kind.owner, array.rows()).first->second != array.rows())
            refuse(files.path(name), "has " + std::to_string(array.rows()) + " rows; allowed is " +
                                         std::to_string(rows[kind.owner]) + ", as the other arrays have");
        for (const float value : array.values)
            if (kind.is_share && !(value >= 0 && value <= 1))
                refuse(files.path(name), "holds " + std::to_string(value) + "; allowed is 0 to 1");
        result.arrays.push_back(std::move(array));
    }
}

CubeTexels texels_of(const NpyArray& array, std::size_t first, std::size_t count) {
    CubeTexels texels(count);
    const float* value = array.values.data() + 3 * first;
    for (Vec3f& texel : texels) {
        texel = {value[0], value[1], value[2]};
        value += 3;
    }
    return texels;
}

void read_maps(const ResultFiles& files, StoredResult& result) {
    const NpyArray diffuse = files.array("diffuse.npy"), specular = files.array("specular.npy");
    if (diffuse.shape.empty() || specular.shape.empty()) return;
    const auto n = static_cast<std::size_t>(result.request.irradiance.face_size);
    const auto maps = static_cast<std::size_t>(result.request.irradiance.specular_maps);
    expect_shape(files.path("diffuse.npy"), diffuse.shape, {6, n, n, 3});
    expect_shape(files.path("specular.npy"), specular.shape, {maps, 6, n, n, 3});
    IrradianceMaps target;
    target.face_size = static_cast<int>(n);
    const std::size_t texels = 6 * n * n;
    target.diffuse = texels_of(diffuse, 0, texels);
    for (std::size_t m = 0; m < maps; ++m) target.specular.push_back(texels_of(specular, m * texels, texels));
    result.maps = to_map_set(target, result.request.fiber);
}

InputDigests input_digests(const Json& manifest) {
    InputDigests digests;
    for (const auto& [name, input] : manifest.at("inputs").items())
        digests[name] = input.at("sha256").get<std::string>();
    return digests;
}

std::map<std::string, std::string> absolute_paths(const Json& manifest) {
    std::map<std::string, std::string> paths;
    for (const auto& [name, input] : manifest.at("inputs").items())
        if (input.contains("absolute_path")) paths[name] = input["absolute_path"].get<std::string>();
    return paths;
}

}  // namespace

StoredResult read_result(const fs::path& folder) {
    const fs::path file = folder / "manifest.json";
    const Json manifest = read_manifest(file);
    StoredResult result;
    try {
        merge_json(result.request, manifest.at("request").dump(), file.string());
        validate(result.request);
        result.digests = input_digests(manifest);
        result.absolute_paths = absolute_paths(manifest);
        const ResultFiles files(folder, manifest);
        result.hair_file_digest = files.digest("transmittance.hair");
        read_arrays(files, result);
        read_maps(files, result);
    } catch (const Json::exception& error) {
        refuse(file, std::string("is not a manifest of hairbake: ") + json_reason(error));
    } catch (const Error& error) {
        if (error.kind() != ErrorKind::usage) throw;
        refuse(file, std::string("holds a request that is not valid: ") + error.what());
    }
    return result;
}

}  // namespace hairbake
