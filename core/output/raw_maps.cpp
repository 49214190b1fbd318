#include "core/output/raw_maps.h"

#include <nlohmann/json.hpp>
#include <span>

#include "core/output/format_table.h"
#include "core/output/half.h"
#include "core/output/map_metadata.h"
#include "core/output/raw_strands.h"

namespace hairbake {
namespace {

using Json = nlohmann::ordered_json;

Json list_of_maps(const MapSet& maps, std::size_t bytes) {
    Json list = Json::array();
    for (const MapLobe& lobe : maps.lobes)
        for (std::size_t i = 0; i < lobe.cubes.size(); ++i) {
            Json map{{"name", lobe.name}};
            if (lobe.has_slices()) map["theta_prime_deg"] = lobe.theta_prime_deg[i / lobe.orders];
            map["offset"] = list.size() * bytes;
            map["bytes"] = bytes;
            list.push_back(map);
        }
    return list;
}

Json description(const MapSet& maps, const std::string& primaries, double scale) {
    const auto n = static_cast<std::size_t>(maps.face_size);
    Json page{{"content", "hairbake irradiance maps"},
              {"file", "maps.f16"},
              {"type", "float16"},
              {"byte_order", "little"},
              {"shape", {maps.cube_count(), cube_faces, n, n, 4}},
              {"face_size", n},
              {"channels", "RGBA"}};
    page["faces"] = Json::array();
    for (int face = 0; face < cube_faces; ++face) page["faces"].push_back(std::string(cube_face_name(face)));
    page["rows"] = "from the top";
    page["scale"] = scale;
    for (const auto& [name, value] : maps.parameters) page[name] = value;
    for (const auto& [key, value] : map_metadata(maps, "all"))
        if (key == "hairbake:model" || key == "hairbake:units" || key == "hairbake:frame")
            page[key.substr(key.find(':') + 1)] = value;
    page["primaries"] = primaries;
    page["maps"] = list_of_maps(maps, cube_faces * n * n * sizeof(Half4));
    return page;
}

}  // namespace

std::vector<WrittenFile> write_map_raw(const MapSet& maps, const std::string& primaries,
                                       const std::filesystem::path& folder, Progress& progress) {
    const double scale = half_scale(maps);
    FileSink texels(folder / "maps.f16");
    for (const MapLobe& lobe : maps.lobes)
        for (const CubeTexels& cube : lobe.cubes) {
            progress.check();
            texels.write(std::as_bytes(std::span<const Half4>(to_half_texels(cube, scale))));
        }
    FileSink json(folder / "maps.json");
    const Json page = description(maps, primaries, scale);
    json.write(page.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");

    std::vector<WrittenFile> files{texels.finish(), json.finish()};
    files[0].shape = page["shape"].get<std::vector<std::size_t>>();
    files[0].content = "diffuse and specular maps: half floats, RGBA; maps.json tells the layout";
    files[0].scale = scale;
    files[1].content = "layout and meaning of maps.f16";
    return files;
}

std::vector<WrittenFile> write_raw(const OutputContext& context, const StagePart& part) {
    context.progress.check();
    if (part.maps)
        return write_map_raw(*part.maps, context.result.inputs.environment->primaries.name, context.folder,
                             context.progress);
    if (find_array(part.arrays, average_transmittance_kind()))
        return write_strand_raw(*context.result.hair, part.arrays, context.folder);
    return {};
}

}  // namespace hairbake
