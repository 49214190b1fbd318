#include "server/jobs/bake_manifest.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

namespace hairbake {
namespace {

using Json = nlohmann::ordered_json;
using Parts = std::vector<std::pair<std::string, Json>>;  // kind and manifest

Json merged(const Parts& parts, const char* block) {
    Json whole = Json::object();
    for (const auto& [kind, part] : parts)
        if (part.contains(block)) whole.update(part[block]);
    return whole;
}

Json joined(const Parts& parts, const char* list) {
    Json whole = Json::array();
    for (const auto& [kind, part] : parts)
        for (const Json& item : part.value(list, Json::array()))
            if (std::find(whole.begin(), whole.end(), item) == whole.end()) whole.push_back(item);  // of a shared input
    return whole;
}

Json files(const Parts& parts) {
    Json list = Json::array();
    for (const auto& [kind, part] : parts)
        for (Json file : part.at("files")) {
            file["name"] = file_name_in_bake(kind, file.at("name").get<std::string>());
            list.push_back(std::move(file));
        }
    return list;
}

Json timings(const Parts& parts) {
    Json sum = Json::object();
    for (const auto& [kind, part] : parts)
        for (const auto& [name, seconds] : part.at("timings_s").items())
            sum[name] = sum.value(name, 0.0) + seconds.get<double>();
    return sum;
}

Json peak_memory(const Parts& parts) {
    std::uint64_t peak = 0;
    for (const auto& [kind, part] : parts) peak = std::max(peak, part.value("peak_memory_bytes", std::uint64_t(0)));
    return peak;
}

}  // namespace

std::string file_name_in_bake(const std::string& stage_kind, const std::string& file_name) {
    return file_name == "preview.png" ? "preview_" + stage_kind + ".png" : file_name;
}

std::string make_bake_manifest(const std::string& id, const std::string& request,
                               const std::vector<StageManifest>& manifests) {
    Parts parts;
    for (const StageManifest& manifest : manifests) parts.emplace_back(manifest.kind, Json::parse(manifest.json));
    // Blocks that only one stage has are taken over as they are.
    Json manifest = Json::object();
    for (const auto& [kind, part] : parts)
        for (const auto& [name, value] : part.items())
            if (!manifest.contains(name) || manifest[name].is_null()) manifest[name] = value;
    manifest["id"] = id;
    manifest["request"] = Json::parse(request);
    for (const char* block : {"stages", "inputs", "repairs", "conventions"}) manifest[block] = merged(parts, block);
    manifest["warnings"] = joined(parts, "warnings");
    manifest["files"] = files(parts);
    manifest["timings_s"] = timings(parts);
    manifest["peak_memory_bytes"] = peak_memory(parts);
    return manifest.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace hairbake
