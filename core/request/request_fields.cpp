#include "core/request/request_fields.h"

#include <algorithm>
#include <utility>

#include "core/base/error.h"
#include "core/request/field_kinds.h"

namespace hairbake {

using Json = RequestField::Json;

void refuse_value(const std::string& path, const Json& found, const std::string& allowed) {
    std::string shown = found.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (shown.size() > 60) shown = shown.substr(0, 57) + "...";
    throw Error(ErrorKind::usage, path + " is " + shown + "; allowed is " + allowed, path);
}

namespace {

using namespace field_kinds;

Field opacity(const std::string& path) {
    return {
        path,
        [](const BakeRequest& r) { return r.strand.opacity_from_file ? Json("from_file") : Json(r.strand.opacity); },
        [=](BakeRequest& r, const Json& v) {
            r.strand.opacity_from_file = v == "from_file";
            r.strand.opacity =
                r.strand.opacity_from_file ? 1 : read_number(path, v, "a number from 0 to 1 or \"from_file\"");
        }};
}

Vec3d read_vector(const std::string& path, const Json& value) {
    if (!value.is_array() || value.size() != 3) refuse_value(path, value, "a list of three numbers");
    return {read_number(path, value[0]), read_number(path, value[1]), read_number(path, value[2])};
}

DirectionalLight read_light(const std::string& path, const Json& value) {
    if (!value.is_object() || value.size() != 2 || !value.contains("direction") || !value.contains("irradiance"))
        refuse_value(path, value, "an object of direction and irradiance, each a list of three numbers");
    return {read_vector(path + ".direction", value["direction"]),
            read_vector(path + ".irradiance", value["irradiance"])};
}

Json light_to_json(const DirectionalLight& light) {
    const auto list = [](const Vec3d& v) { return Json{v.x, v.y, v.z}; };
    return {{"direction", list(light.direction)}, {"irradiance", list(light.irradiance)}};
}

Field lights(const std::string& path) {
    return {path,
            [](const BakeRequest& r) {
                Json list = Json::array();
                for (const DirectionalLight& light : r.irradiance.lights) list.push_back(light_to_json(light));
                return list;
            },
            [=](BakeRequest& r, const Json& v) {
                if (!v.is_array()) refuse_value(path, v, "a list of lights");
                std::vector<DirectionalLight> items;
                for (std::size_t i = 0; i < v.size(); ++i)
                    items.push_back(read_light(path + "[" + std::to_string(i) + "]", v[i]));
                r.irradiance.lights = std::move(items);
            }};
}

// ---- the request, field by field -----------------------------------------------------------------------------------

#define AT(member) \
    [](auto& r) -> auto& { return r.member; }  // NOLINT(bugprone-macro-parentheses): a member cannot stand in them

std::vector<Field> hair_fields() {
    using D = DirectionSet;
    return {
        optional_string("hair", AT(hair)),
        optional_string("environment", AT(environment)),
        optional_string("occluder", AT(occluder)),
        optional_string("receiver", AT(receiver)),
        optional_number("strand.width", AT(strand.width)),
        number("strand.width_scale", AT(strand.width_scale)),
        opacity("strand.opacity"),
        added(number("strand.time", AT(strand.time)), 0.0),
        choice("transmittance.method", transmittance_method_names, AT(transmittance.method)),
        integer("transmittance.directions", AT(transmittance.directions)),
        choice<D>("transmittance.direction_set",
                  {{"fibonacci", D::fibonacci}, {"stratified", D::stratified}, {"random", D::random}},
                  AT(transmittance.direction_set)),
        integer("transmittance.seed", AT(transmittance.seed)),
        integer_or_auto("transmittance.voxels", AT(transmittance.voxels)),
        optional_number("transmittance.voxel_size", AT(transmittance.voxel_size)),
        integer("transmittance.sh_bands", AT(transmittance.sh_bands)),
        boolean("transmittance.bent_cone", AT(transmittance.bent_cone)),
        integer("transmittance.opacity_maps.layers", AT(transmittance.opacity_maps.layers)),
        number("transmittance.opacity_maps.layer_spacing", AT(transmittance.opacity_maps.layer_spacing)),
        integer("transmittance.opacity_maps.resolution", AT(transmittance.opacity_maps.resolution)),
        integer("transmittance.reference_vertices", AT(transmittance.reference_vertices)),
    };
}

/// The model, and one field for each parameter of each model.
std::vector<Field> fiber_fields() {
    Names<FiberModelKind> names;
    for (const FiberModelEntry& entry : fiber_models) names.emplace_back(entry.name, entry.kind);
    std::vector<Field> fields{
        moved(choice<FiberModelKind>("fiber.model", std::move(names), AT(fiber.model)), "irradiance.model")};
    for (const FiberNumber& entry : fiber_numbers) {
        const std::string path = path_of(entry);
        fields.push_back(
            {path, [entry](const BakeRequest& r) { return Json(entry.of(r.fiber)); },
             [entry, path](BakeRequest& r, const Json& v) { entry.member(r.fiber) = read_number(path, v); }});
        if (path == "fiber.kajiya_kay.exponent") fields.back().first_path = "irradiance.exponent";
    }
    return fields;
}

std::vector<Field> environment_fields() {
    return {
        moved(choice("environment_settings.layout", environment_layout_names, AT(environment_settings.layout)),
              "irradiance.layout"),
        moved(choice("environment_settings.latlong", latlong_names, AT(environment_settings.latlong)),
              "irradiance.latlong"),
        moved(triple("environment_settings.rotation_deg", AT(environment_settings.rotation_deg)),
              "irradiance.rotation_deg"),
        moved(number("environment_settings.exposure_stops", AT(environment_settings.exposure_stops)),
              "irradiance.exposure_stops"),
        moved(triple("environment_settings.tint", AT(environment_settings.tint)), "irradiance.tint"),
        moved(choice("environment_settings.invalid_radiance", invalid_radiance_names,
                     AT(environment_settings.invalid_radiance)),
              "irradiance.invalid_radiance"),
        added(choice("environment_settings.to_primaries", to_primaries_names, AT(environment_settings.to_primaries)),
              "file"),
    };
}

std::vector<Field> irradiance_fields() {
    return {
        integer("irradiance.face_size", AT(irradiance.face_size)),
        integer("irradiance.specular_maps", AT(irradiance.specular_maps)),
        choice("irradiance.method", irradiance_method_names, AT(irradiance.method)),
        integer_or_auto("irradiance.sh_bands.diffuse", AT(irradiance.sh_bands_diffuse)),
        integer_or_auto("irradiance.sh_bands.specular", AT(irradiance.sh_bands_specular)),
        number("irradiance.sh_error", AT(irradiance.sh_error)),
        boolean("irradiance.clamp_negative", AT(irradiance.clamp_negative)),
        lights("irradiance.lights"),
    };
}

/// The stage is younger than the first version: with `enabled` false nothing of it is in any key.
std::vector<Field> effective_fields() {
    return {
        added(boolean("effective_transmittance.enabled", AT(effective_transmittance.enabled)), false),
        integer("effective_transmittance.lights", AT(effective_transmittance.lights)),
        integer("effective_transmittance.cosines", AT(effective_transmittance.cosines)),
        choice("effective_transmittance.diffuse", effective_diffuse_names, AT(effective_transmittance.diffuse)),
        integer("effective_transmittance.reference_neighborhoods", AT(effective_transmittance.reference_neighborhoods)),
    };
}

std::vector<Field> make_fields() {
    std::vector<Field> fields;
    for (auto block : {hair_fields, fiber_fields, environment_fields, irradiance_fields, effective_fields})
        for (Field& field : block()) fields.push_back(std::move(field));
    fields.push_back(string_list("outputs", AT(outputs)));
    return fields;
}
#undef AT

}  // namespace

const std::vector<RequestField>& request_fields() {
    static const std::vector<RequestField> table = make_fields();
    return table;
}

const RequestField* find_field(const std::string& path) {
    for (const RequestField& field : request_fields())
        if (field.path == path || (!field.first_path.empty() && field.first_path == path)) return &field;
    return nullptr;
}

bool in_block(std::string_view path, std::string_view block) {
    return path.size() > block.size() && path.starts_with(block) && path[block.size()] == '.';
}

bool is_or_lies_in(std::string_view path, std::string_view field_or_block) {
    return path == field_or_block || in_block(path, field_or_block);
}

void set_at(Json& object, const std::string& path, Json value) {
    std::string pointer = "/" + path;
    std::replace(pointer.begin(), pointer.end(), '.', '/');
    object[Json::json_pointer(pointer)] = std::move(value);
}

}  // namespace hairbake
