#include "core/output/manifest.h"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>
#include <thread>

#include "core/base/error.h"
#include "core/base/json_nesting.h"
#include "core/base/json_reason.h"
#include "core/output/manifest_stages.h"
#include "core/output/versions.h"
#include "core/request/request_json.h"
#include "core/request/stages.h"

namespace hairbake {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* format_name = "hairbake result";

template <class T>
Json triple(const Vec3<T>& v) {
    return {v.x, v.y, v.z};
}

Json stages(const BakeResult& result) {
    Json block = Json::object();
    for (const StagePart& part : result.parts)
        block[std::string(part.stage->name)] = {{"key", part.key}, {"algorithm", part.stage->algorithm}};
    return block;
}

Json hair_input(const HairFacts& facts) {
    return {{"strands", facts.strands},
            {"vertices", facts.vertices},
            {"segments", facts.segments},
            {"bounds", {triple(facts.bounds_min), triple(facts.bounds_max)}}};
}

Json environment_input(const EnvironmentMap& map) {
    Json block = Json::object();
    if (map.shape == EnvironmentShape::cube)
        block["face_size"] = map.width;
    else
        block.update({{"width", map.width}, {"height", map.height}});
    block["format"] = map.source_format;
    block["layout"] = std::string(name_of(map.layout));
    if (map.shape == EnvironmentShape::latlong) block["latlong"] = std::string(name_of(map.latlong));
    block["primaries"] = map.primaries.name;
    if (map.primaries.xy) block["chromaticities"] = *map.primaries.xy;
    block["low_dynamic_range"] = map.low_dynamic_range;
    block["energy"] = map.repairs.energy_total;
    block["invalid_pixels"] = {{"negative", map.repairs.negative_pixels},
                               {"nan", map.repairs.nan_pixels},
                               {"infinite", map.repairs.infinite_pixels}};
    block["energy_removed"] = map.repairs.energy_removed;
    return block;
}

Json receiver_input(const MeshFacts& mesh) {
    return {{"format", mesh.format},
            {"positions", mesh.positions},
            {"faces", mesh.faces},
            {"concave_faces", mesh.concave_faces},
            {"crossing_faces", mesh.crossing_faces},
            {"triangles", mesh.triangles},
            {"turned_triangles", mesh.turned_triangles}};
}

Json occluder_input(const MeshFacts& mesh) {
    Json block = receiver_input(mesh);
    block.update({{"closed", mesh.topology.closed},
                  {"open_edges", mesh.topology.open_edges},
                  {"irregular_edges", mesh.topology.irregular_edges},
                  {"hair_vertices", {{"looked_at", mesh.vertices_looked_at}, {"inside", mesh.vertices_inside}}}});
    return block;
}

Json inputs(const InputFacts& facts) {
    Json block = Json::object();
    const auto add = [&](const char* name, const Json& described) {
        block[name] = {{"sha256", facts.digests.at(name)}};
        if (const auto path = facts.paths.find(name); path != facts.paths.end())
            block[name].update({{"path", path->second.given}, {"absolute_path", path->second.absolute}});
        block[name].update(described);
    };
    if (facts.hair) add("hair", hair_input(*facts.hair));
    if (facts.occluder) add("occluder", occluder_input(*facts.occluder));
    if (facts.receiver) add("receiver", receiver_input(*facts.receiver));
    if (facts.environment) add("environment", environment_input(*facts.environment));
    return block;
}

Json conventions() {
    return {{"frame", "right-handed, Y up; lengths in the model's unit; radiance linear RGB"},
            {"tangent", "root to tip; directions point away from the hair"},
            {"theta_prime", "from the tangent; map m of M + 1 is for m * 180 / M degrees"},
            {"cube_faces", "+X -X +Y -Y +Z -Z, OpenGL orientation, rows from the top"},
            {"latlong", "files are gltf: row 0 is +Y, centre column +X, right of it +Z"},
            {"half_floats", "the value is what is stored times the file's scale; only level 0 is for tangents"},
            {"vertices", "the hair file's point order"},
            {"units", "maps: radiance times steradian, Kd and Ks not applied; transmittance: 0 to 1"}};
}

/// The repairs of the inputs, and the parts of them that were left out.
Json repairs(const BakeResult& result) {
    Json block = Json::object();
    for (const StagePart& part : result.parts)
        if (const auto* facts = std::get_if<TransmittanceFacts>(&part.facts))
            block["hair"] = {{"degenerate_segments", facts->degenerate_segments}};
    if (result.inputs.environment) {
        const RadianceRepairs& done = result.inputs.environment->repairs;
        block["environment"] = {{"negative_pixels", done.negative_pixels},
                                {"nan_pixels", done.nan_pixels},
                                {"infinite_pixels", done.infinite_pixels},
                                {"energy_removed", done.energy_removed}};
    }
    return block;
}

Json versions() {
    Json block{{"hairbake", version()}};
    for (const auto& [name, number] : library_versions()) block[name] = number;
    return block;
}

Json file_list(const std::vector<WrittenFile>& files) {
    Json list = Json::array();
    for (const WrittenFile& file : files) {
        Json entry{{"name", file.name}, {"sha256", file.sha256}, {"bytes", file.bytes}};
        if (!file.shape.empty()) entry["shape"] = file.shape;
        entry["content"] = file.content;
        if (file.scale) entry["scale"] = *file.scale;
        list.push_back(entry);
    }
    return list;
}

Json measured(const BakeResult& result) {
    Json block{{"about", "this block, timings_s and peak_memory_bytes differ between runs; nothing else does"},
               {"threads", result.measured.threads},
               {"processors", std::thread::hardware_concurrency()}};
    const auto seconds = result.measured.timings_s.find("transmittance");
    const VertexArray* average = result.array(average_transmittance_kind());
    if (average && seconds != result.measured.timings_s.end() && seconds->second > 0)
        block["rays_per_second"] =
            static_cast<double>(average->rows()) * result.request.transmittance.directions / seconds->second;
    return block;
}

}  // namespace

std::string make_manifest(const BakeResult& result, const std::vector<WrittenFile>& files) {
    Json manifest{{"format", format_name}, {"format_version", output_format}, {"id", result.id}};
    manifest["stages"] = stages(result);
    manifest["request"] = Json::parse(to_json(result.request));
    manifest["inputs"] = inputs(result.inputs);
    for (const StagePart& part : result.parts) manifest.update(describe_part(part, result.request));
    if (!manifest.contains("error_bar")) manifest["error_bar"] = nullptr;
    manifest["conventions"] = conventions();
    manifest["repairs"] = repairs(result);
    manifest["warnings"] = result.warnings;
    manifest["versions"] = versions();
    manifest["files"] = file_list(files);
    manifest["timings_s"] = result.measured.timings_s;
    manifest["peak_memory_bytes"] = result.measured.peak_memory_bytes;
    manifest["measured"] = measured(result);
    return manifest.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void write_manifest(const BakeResult& result, const std::vector<WrittenFile>& files,
                    const std::filesystem::path& folder) {
    FileSink sink(folder / "manifest.json");
    sink.write(make_manifest(result, files));
    sink.finish();
}

std::string read_manifest_text(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw Error(ErrorKind::bad_input, file.string() + ": " + std::generic_category().message(errno));
    constexpr std::size_t most = std::size_t(16) << 20;
    std::string text(most + 1, '\0');
    stream.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(stream.gcount()));
    if (text.size() > most)
        throw Error(ErrorKind::bad_input, file.string() + " is longer than a manifest may be (16 MiB)");
    check_nesting(text, file.string(), ErrorKind::bad_input);
    return text;
}

std::vector<std::string> files_of_result(const std::filesystem::path& folder) {
    const std::filesystem::path file = folder / "manifest.json";
    const std::string text = read_manifest_text(file);
    try {
        const Json manifest = Json::parse(text);
        if (manifest.at("format") != format_name)
            throw Error(ErrorKind::bad_input, file.string() + " is not a manifest of hairbake");
        std::vector<std::string> names;
        for (const Json& entry : manifest.at("files")) names.push_back(entry.at("name").get<std::string>());
        return names;
    } catch (const Json::exception& error) {
        throw Error(ErrorKind::bad_input, file.string() + " is not a manifest of hairbake: " + json_reason(error));
    }
}

}  // namespace hairbake
