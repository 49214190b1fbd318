#include "core/tools/inspect.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/bounds.h"
#include "core/base/error.h"
#include "core/environment/cube_map.h"
#include "core/environment/environment_files.h"
#include "core/environment/environment_reader.h"
#include "core/hair/hair_file.h"
#include "core/hair/strand_geometry.h"
#include "core/mesh/mesh_file.h"
#include "core/mesh/mesh_topology.h"
#include "core/output/manifest.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

/// Smallest, mean and largest of the array, or the header's default where the file has none.
Json range_of(std::span<const float> values, float otherwise) {
    if (values.empty()) return {{"default", otherwise}};
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    const double sum = std::accumulate(values.begin(), values.end(), 0.0);
    return {{"minimum", *low}, {"mean", sum / static_cast<double>(values.size())}, {"maximum", *high}};
}

/// Facts of the widths, in the model's unit.
Json width_facts(const HairModel& model) {
    Json facts = range_of(model.thickness, model.default_thickness);
    if (const auto zeros = std::count(model.thickness.begin(), model.thickness.end(), 0.0f); zeros > 0)
        facts["vertices_of_width_0"] = zeros;
    return facts;
}

/// The reason why a bake that takes the widths from the file will be refused; empty where it will not be.
std::string width_warning(const HairModel& model) {
    const bool none = model.thickness.empty() ? !(model.default_thickness > 0)
                                              : std::ranges::all_of(model.thickness, [](float w) { return w == 0; });
    if (none && model.vertex_count() > 0) return "the model has no strand width: a bake needs strand.width (--width)";
    try {
        make_strand_geometry(model, {});
    } catch (const Error& error) {
        if (error.field() == "strand.width") return error.what();
    }
    return "";
}

Json hair_facts(const fs::path& file) {
    const Groom groom = read_groom(file);
    const HairModel& model = groom.model;
    Json facts{{"kind", "hair model"},
               {"format", model.format},
               {"strands", model.strand_count()},
               {"vertices", model.vertex_count()}};
    std::uint32_t longest = 0;
    for (std::size_t s = 0; s < model.strand_count(); ++s)
        longest = std::max(longest, model.strand_begin[s + 1] - model.strand_begin[s]);
    facts["longest_strand"] = longest;
    if (!model.positions.empty()) {
        const auto [low, high] = bounds_of(model.positions);
        facts["bounds"] = {{"minimum", as_array(low)}, {"maximum", as_array(high)}};
    }
    facts["thickness"] = width_facts(model);
    facts["transparency"] = range_of(model.transparency, model.default_transparency);
    facts["colors"] = model.colors.empty() ? Json(as_array(model.default_color)) : Json("one a vertex");
    facts["info"] = groom.description;
    std::vector<std::string> warnings = groom.warnings;
    if (const std::string warning = width_warning(model); !warning.empty()) warnings.push_back(warning);
    if (!warnings.empty()) facts["warnings"] = warnings;
    return facts;
}

Json mesh_facts(const fs::path& file) {
    const MeshFile read = read_mesh_file(file);
    const MeshTopology topology = topology_of(read.mesh);
    const auto [low, high] = bounds_of(read.mesh.positions);
    std::vector<std::string> warnings;
    for (const std::string& warning : read.warnings) warnings.push_back("the mesh: " + warning);
    Json facts{{"kind", "mesh"},
               {"format", read.format},
               {"positions", read.mesh.positions.size()},
               {"faces", read.faces},
               {"concave_faces", read.concave_faces},
               {"crossing_faces", read.crossing_faces},
               {"triangles", read.mesh.triangles.size()},
               {"turned_triangles", read.turned_triangles},
               {"closed", topology.closed},
               {"open_edges", topology.open_edges},
               {"irregular_edges", topology.irregular_edges},
               {"bounds", {{"minimum", as_array(low)}, {"maximum", as_array(high)}}}};
    if (!warnings.empty()) facts["warnings"] = warnings;
    return facts;
}

Json brightest_pixel(const EnvironmentMap& map) {
    const auto sum = [](const Vec3f& c) { return c.x + c.y + c.z; };
    const auto brightest = std::max_element(map.pixels.begin(), map.pixels.end(),
                                            [&](const Vec3f& a, const Vec3f& b) { return sum(a) < sum(b); });
    const auto index = static_cast<std::size_t>(brightest - map.pixels.begin());
    const std::size_t row = index / map.width, column = index % map.width;
    Json facts = Json::object();
    const bool cube = map.shape == EnvironmentShape::cube;
    if (cube) facts["face"] = std::string(cube_face_name(static_cast<int>(row / map.width)));
    facts["row"] = cube ? row % map.width : row;
    facts["column"] = column;
    facts["radiance"] = as_array(*brightest);
    facts["direction"] = as_array(direction_of(map, {column + 0.5, row + 0.5}));
    return facts;
}

/// A sun or small lamps: the pixels that have at least an eighth of the largest radiance. Null unless these pixels
/// together are smaller than a disc 9 degrees across (0.02 sr) and hold at least a twentieth of the light.
Json small_lights(const EnvironmentMap& map) {
    const auto sum = [](const Vec3f& c) { return double(c.x) + c.y + c.z; };
    double largest = 0;
    for (const Vec3f& pixel : map.pixels) largest = std::max(largest, sum(pixel));
    const TexelSolidAngles solid_angles = texel_solid_angles(map);
    double total = 0, held = 0, size = 0;
    std::size_t pixels = 0;
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x) {
            const double radiance = sum(map.pixels[std::size_t(y) * map.width + x]), angle = solid_angles.at(x, y);
            total += radiance * angle;
            if (radiance < largest / 8) continue;
            held += radiance * angle;
            size += angle;
            ++pixels;
        }
    if (total <= 0 || held < 0.05 * total || size > 0.02) return nullptr;
    return {{"pixels", pixels}, {"share", held / total}};
}

Json mean_radiance(const EnvironmentMap& map) {
    const TexelSolidAngles solid_angles = texel_solid_angles(map);
    Vec3d sum;
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x)
            sum += Vec3d(map.pixels[std::size_t(y) * map.width + x]) * solid_angles.at(x, y);
    return as_array(sum / (4 * std::numbers::pi));
}

Json environment_facts(const fs::path& file, Progress& progress) {
    EnvironmentSettings settings;
    settings.invalid_radiance = InvalidRadiance::clamp;  // so that every map can be looked at; counted below
    const EnvironmentMap map = read_environment(file, settings, progress);
    Json facts{
        {"kind", "environment map"}, {"format", map.source_format}, {"layout", std::string(name_of(map.layout))}};
    if (map.shape == EnvironmentShape::cube)
        facts["face_size"] = map.width;
    else
        facts.update({{"width", map.width}, {"height", map.height}});
    if (map.shape == EnvironmentShape::latlong) facts["latlong"] = std::string(name_of(map.latlong));
    facts["primaries"] = map.primaries.name;
    facts["low_dynamic_range"] = map.low_dynamic_range;
    facts["mean_radiance"] = mean_radiance(map);
    facts["brightest_pixel"] = brightest_pixel(map);
    if (const Json lights = small_lights(map); !lights.is_null()) facts["small_lights"] = lights;
    const RadianceRepairs& repairs = map.repairs;
    facts["invalid_pixels"] = {
        {"negative", repairs.negative_pixels}, {"nan", repairs.nan_pixels}, {"infinite", repairs.infinite_pixels}};
    facts["negative_energy"] = repairs.energy_removed;
    facts["warnings"] = map.warnings;
    return facts;
}

/// Blocks of a manifest that `hairbake info` leaves out: those equal in every manifest, those that repeat the request,
/// and those with an entry for each map.
constexpr std::array<std::string_view, 7> left_out{"format",      "format_version", "request", "irradiance",
                                                   "conventions", "files",          "measured"};

Json result_facts(const fs::path& folder) {
    files_of_result(folder);  // throws unless it is a result
    const Json manifest = Json::parse(read_manifest_text(folder / "manifest.json"));
    Json facts{{"kind", "bake result"}};
    for (const auto& [name, block] : manifest.items())
        if (std::find(left_out.begin(), left_out.end(), name) == left_out.end()) facts[name] = block;
    Json files = Json::object();
    for (const Json& file : manifest["files"]) files[file.at("name").get<std::string>()] = file.value("bytes", 0ull);
    facts["files"] = files;
    return facts;
}

/// Facts of a result folder, or of a folder with the six faces of an environment.
Json folder_facts(const fs::path& folder, Progress& progress) {
    if (fs::exists(folder / "manifest.json")) return result_facts(folder);
    try {
        return environment_facts(folder, progress);
    } catch (const Error& error) {
        throw Error(error.kind(), std::string(error.what()) + "; nor is there the manifest.json of a bake result",
                    error.field());
    }
}

std::string value_text(const Json& value) {
    if (value.is_string()) return value.get<std::string>();
    if (value.is_number_float()) {
        char buffer[32];
        std::snprintf(buffer, sizeof buffer, "%.6g", value.get<double>());
        return buffer;
    }
    if (!value.is_array()) return value.dump();
    std::string list;
    for (const Json& item : value) list += (list.empty() ? "" : "  ") + value_text(item);
    return list;
}

std::string lines_of(const Json& object, const std::string& prefix) {
    std::string lines;
    for (const auto& [name, value] : object.items()) {
        if (value.is_object()) {
            lines += lines_of(value, prefix + name + ".");
        } else if (!(value.is_array() && value.empty())) {
            std::string label = prefix + name;
            label.resize(std::max<std::size_t>(label.size() + 2, 34), ' ');
            lines += label + value_text(value) + "\n";
        }
    }
    return lines;
}

}  // namespace

std::string inspect(const fs::path& path, Progress& progress) {
    Json facts{{"path", path.string()}};
    if (fs::is_directory(path))
        facts.update(folder_facts(path, progress));
    else if (path.filename() == "manifest.json")
        facts.update(result_facts(path.has_parent_path() ? path.parent_path() : "."));
    else if (find_environment_files(path).faces())
        facts.update(environment_facts(path, progress));
    else if (is_hair_file(path))
        facts.update(hair_facts(path));
    else
        facts.update(is_mesh_file(path) ? mesh_facts(path) : environment_facts(path, progress));
    return facts.dump(2, ' ', false, Json::error_handler_t::replace);
}

std::string as_lines(const std::string& json_object) { return lines_of(Json::parse(json_object), ""); }

}  // namespace hairbake
