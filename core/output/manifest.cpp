#include "core/output/manifest.h"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>
#include <thread>

#include "core/base/error.h"
#include "core/base/json_nesting.h"
#include "core/output/map_metadata.h"
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
    for (const Stage& stage : hairbake::stages())
        if (const auto key = result.keys.find(stage.name); key != result.keys.end())
            block[std::string(stage.name)] = {{"key", key->second}, {"algorithm", stage.algorithm}};
    return block;
}

Json hair_input(const BakeResult& result) {
    const HairFacts& facts = result.hair_facts;
    return {{"sha256", result.digests.at("hair")},
            {"strands", facts.strands},
            {"vertices", facts.vertices},
            {"segments", facts.segments},
            {"bounds", {triple(facts.bounds_min), triple(facts.bounds_max)}}};
}

Json environment_input(const BakeResult& result) {
    const EnvironmentMap& map = *result.environment;
    Json block{{"sha256", result.digests.at("environment")}};
    if (map.shape == EnvironmentShape::cube)
        block["face_size"] = map.width;
    else
        block.update({{"width", map.width}, {"height", map.height}});
    block["format"] = map.source_format;
    block["layout"] = map.layout;
    if (map.shape == EnvironmentShape::latlong) block["latlong"] = std::string(name_of(map.latlong));
    block["primaries"] = map.primaries;
    block["low_dynamic_range"] = map.low_dynamic_range;
    block["energy"] = map.repairs.energy_total;
    return block;
}

Json occluder_input(const BakeResult& result) {
    const MeshTopology& topology = result.occluder_topology;
    return {{"sha256", result.digests.at("occluder")},
            {"positions", result.occluder->positions.size()},
            {"triangles", result.occluder->triangles.size()},
            {"closed", topology.closed},
            {"open_edges", topology.open_edges},
            {"irregular_edges", topology.irregular_edges}};
}

Json receiver_input(const BakeResult& result) {
    return {{"sha256", result.digests.at("receiver")},
            {"positions", result.receiver->positions.size()},
            {"triangles", result.receiver->triangles.size()}};
}

Json inputs(const BakeResult& result) {
    Json block = Json::object();
    if (result.transmittance) block["hair"] = hair_input(result);
    if (result.occluder) block["occluder"] = occluder_input(result);
    if (result.receiver) block["receiver"] = receiver_input(result);
    if (result.environment) block["environment"] = environment_input(result);
    return block;
}

/// Means over the receiver's points; null when it has none.
Json receiver_facts(const std::vector<float>& receiver) {
    double plain = 0, cosine = 0;
    for (std::size_t i = 0; i + 1 < receiver.size(); i += 2) {
        plain += receiver[i];
        cosine += receiver[i + 1];
    }
    const std::size_t positions = receiver.size() / 2;
    const auto points = static_cast<double>(positions);
    return {{"positions", positions},
            {"mean", points > 0 ? Json(plain / points) : Json()},
            {"cosine_mean", points > 0 ? Json(cosine / points) : Json()}};
}

Json transmittance_facts(const BakeResult& result) {
    const Transmittance& transmittance = *result.transmittance;
    const TransmittanceSettings& settings = result.request.transmittance;
    double sum = 0;
    for (const float a : transmittance.average) sum += a;
    const auto& average = transmittance.average;
    const bool any = !average.empty();
    Json block{{"vertices", average.size()},
               {"directions", transmittance.directions},
               {"voxel_size", transmittance.voxel_size},
               {"occupied_voxels", transmittance.occupied_voxels},
               {"mean", any ? Json(sum / static_cast<double>(average.size())) : Json()},
               {"minimum", any ? Json(*std::min_element(average.begin(), average.end())) : Json()},
               {"maximum", any ? Json(*std::max_element(average.begin(), average.end())) : Json()}};
    block["sh_bands"] = settings.sh_bands;
    block["bent_cone"] = settings.bent_cone;
    if (result.receiver) block["receiver"] = receiver_facts(transmittance.receiver);
    return block;
}

/// Without a vertex to measure at there is no error, which is not an error of 0: null.
Json error_bar(const ErrorBar& bar) {
    const auto measured = [&](const auto& value) { return bar.vertices > 0 ? Json(value) : Json(); };
    return {{"rmse", measured(bar.rmse)},
            {"bias", measured(bar.bias)},
            {"ci95", {{"rmse", measured(bar.rmse_ci95)}, {"bias", measured(bar.bias_ci95)}}},
            {"vertices", bar.vertices},
            {"inside_strand", bar.inside_strand},
            {"directions", bar.directions}};
}

Json map_statistics(const MapStatistics& statistics) {
    return {{"mean", triple(statistics.mean)},
            {"minimum", triple(statistics.minimum)},
            {"maximum", triple(statistics.maximum)},
            {"clamped_negative_mass", statistics.clamped_negative_mass}};
}

Json irradiance_facts(const IrradianceMaps& maps, const IrradianceSettings& settings) {
    Json block{{"face_size", maps.face_size}, {"exponent", maps.exponent}};
    block["diffuse"] = map_statistics(maps.diffuse_statistics);
    block["specular"] = Json::array();
    for (std::size_t m = 0; m < maps.specular.size(); ++m) {
        Json map{{"theta_prime_deg", theta_prime_degrees(maps, m)}};
        if (m < maps.specular_statistics.size()) map.update(map_statistics(maps.specular_statistics[m]));
        block["specular"].push_back(map);
    }
    block["interpolation_bound"] = triple(maps.interpolation_bound);
    block["interpolation_bound_relative"] = maps.interpolation_bound_relative;
    block["environment_sh_bands"] = maps.environment_sh_bands;
    if (settings.method == IrradianceMethod::sh) {
        block["sh_bands"] = {{"diffuse", maps.sh_bands_diffuse}, {"specular", maps.sh_bands_specular}};
        block["predicted_error"] = {{"diffuse", maps.predicted_error_diffuse},
                                    {"specular", maps.predicted_error_specular}};
    }
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

Json repairs(const BakeResult& result) {
    Json block = Json::object();
    if (result.transmittance) block["hair"] = {{"degenerate_segments", result.hair_facts.degenerate_segments}};
    if (result.environment) {
        const RadianceRepairs& done = result.environment->repairs;
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
    const double seconds = result.measured.timings_s.at("transmittance");
    if (result.transmittance && seconds > 0)
        block["rays_per_second"] =
            static_cast<double>(result.transmittance->average.size()) * result.transmittance->directions / seconds;
    return block;
}

}  // namespace

std::string make_manifest(const BakeResult& result, const std::vector<WrittenFile>& files) {
    Json manifest{{"format", format_name}, {"format_version", output_format}, {"id", result.id}};
    manifest["stages"] = stages(result);
    manifest["request"] = Json::parse(to_json(result.request));
    manifest["inputs"] = inputs(result);
    if (result.transmittance) manifest["transmittance"] = transmittance_facts(result);
    manifest["error_bar"] = result.error_bar ? error_bar(*result.error_bar) : Json();
    if (result.irradiance) manifest["irradiance"] = irradiance_facts(*result.irradiance, result.request.irradiance);
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
            throw Error(ErrorKind::bad_input, file.string() + " is not of hairbake");
        std::vector<std::string> names;
        for (const Json& entry : manifest.at("files")) names.push_back(entry.at("name").get<std::string>());
        return names;
    } catch (const Json::exception& error) {
        throw Error(ErrorKind::bad_input, file.string() + " is not a manifest of hairbake: " + error.what());
    }
}

}  // namespace hairbake
