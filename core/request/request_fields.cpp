#include "core/request/request_fields.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/error.h"

namespace hairbake {

using Json = RequestField::Json;
using Field = RequestField;

void refuse_value(const std::string& path, const Json& found, const std::string& allowed) {
    std::string shown = found.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (shown.size() > 60) shown = shown.substr(0, 57) + "...";
    throw Error(ErrorKind::usage, path + " is " + shown + "; allowed is " + allowed, path);
}

namespace {

// ---- values ------------------------------------------------------------------------------------------------------

double read_number(const std::string& path, const Json& value, const std::string& allowed = "a number") {
    if (!value.is_number() || !std::isfinite(value.get<double>())) refuse_value(path, value, allowed);
    return value.get<double>();
}

/// 100 and 100.0 are both the integer 100, as in JSON Schema.
template <class Integer>
Integer read_integer(const std::string& path, const Json& value, const std::string& allowed = "an integer") {
    const double number = read_number(path, value, allowed);
    const double high = std::min(0x1p53, static_cast<double>(std::numeric_limits<Integer>::max()));
    const double low = std::max(-0x1p53, static_cast<double>(std::numeric_limits<Integer>::lowest()));
    if (number != std::floor(number) || !(number >= low && number <= high)) refuse_value(path, value, allowed);
    return static_cast<Integer>(number);
}

std::string read_string(const std::string& path, const Json& value, const std::string& allowed = "a string") {
    if (!value.is_string()) refuse_value(path, value, allowed);
    return value.get<std::string>();
}

// ---- kinds of fields; `at` gives a reference to the member of a (const) request -----------------------------------

template <class At>
Field number(std::string path, At at) {
    return {path, [at](const BakeRequest& r) { return Json(at(r)); },
            [=](BakeRequest& r, const Json& v) { at(r) = read_number(path, v); }};
}

template <class At>
Field optional_number(std::string path, At at) {
    return {path, [at](const BakeRequest& r) { return at(r) ? Json(*at(r)) : Json(); },
            [=](BakeRequest& r, const Json& v) {
                at(r).reset();
                if (!v.is_null()) at(r) = read_number(path, v, "a number or null");
            }};
}

template <class At>
Field integer(std::string path, At at) {
    return {path, [at](const BakeRequest& r) { return Json(at(r)); },
            [=](BakeRequest& r, const Json& v) {
                using Integer = std::remove_reference_t<decltype(at(r))>;
                at(r) = read_integer<Integer>(path, v);
            }};
}

template <class At>
Field integer_or_auto(std::string path, At at) {
    return {path, [at](const BakeRequest& r) { return at(r) ? Json(*at(r)) : Json("auto"); },
            [=](BakeRequest& r, const Json& v) {
                at(r).reset();
                if (v != "auto") at(r) = read_integer<int>(path, v, "an integer or \"auto\"");
            }};
}

template <class At>
Field boolean(std::string path, At at) {
    return {path, [at](const BakeRequest& r) { return Json(at(r)); },
            [=](BakeRequest& r, const Json& v) {
                if (!v.is_boolean()) refuse_value(path, v, "true or false");
                at(r) = v.template get<bool>();
            }};
}

template <class At>
Field optional_string(std::string path, At at) {
    return {path, [at](const BakeRequest& r) { return at(r) ? Json(*at(r)) : Json(); },
            [=](BakeRequest& r, const Json& v) {
                at(r).reset();
                if (!v.is_null()) at(r) = read_string(path, v, "a string or null");
            }};
}

template <class At>
Field triple(std::string path, At at) {
    return {path, [at](const BakeRequest& r) { return Json(at(r)); },
            [=](BakeRequest& r, const Json& v) {
                if (!v.is_array() || v.size() != 3) refuse_value(path, v, "a list of three numbers");
                for (std::size_t i = 0; i < 3; ++i) at(r)[i] = read_number(path, v[i]);
            }};
}

template <class At>
Field string_list(std::string path, At at) {
    return {path, [at](const BakeRequest& r) { return Json(at(r)); },
            [=](BakeRequest& r, const Json& v) {
                if (!v.is_array()) refuse_value(path, v, "a list of strings");
                std::vector<std::string> items;
                for (const Json& item : v) items.push_back(read_string(path, item));
                at(r) = std::move(items);
            }};
}

template <class Enum>
using Names = std::vector<std::pair<std::string, Enum>>;

template <class Enum, class At>
Field choice(std::string path, Names<Enum> names, At at) {
    return {path,
            [=](const BakeRequest& r) {
                for (const auto& [name, value] : names)
                    if (value == at(r)) return Json(name);
                throw Error(ErrorKind::internal, path + " holds a value without a name", path);
            },
            [=](BakeRequest& r, const Json& v) {
                std::string allowed;
                for (const auto& [name, value] : names) {
                    if (v == name) {
                        at(r) = value;
                        return;
                    }
                    allowed += (allowed.empty() ? "one of " : ", ") + name;
                }
                refuse_value(path, v, allowed);
            }};
}

/// By the enum's own table of names.
template <class Enum, std::size_t count, class At>
Field choice(std::string path, const std::array<EnumName<Enum>, count>& table, At at) {
    Names<Enum> names;
    for (const EnumName<Enum>& entry : table) names.emplace_back(entry.name, entry.value);
    return choice<Enum>(std::move(path), std::move(names), at);
}

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

/// A field that stood at `first_path` in the first version.
Field moved(Field field, std::string first_path) {
    field.first_path = std::move(first_path);
    return field;
}

/// A field that came after the first version, which did what `first_value` says.
Field added(Field field, Json first_value) {
    field.first_value = std::move(first_value);
    return field;
}

// ---- the request, field by field -----------------------------------------------------------------------------------

#define AT(member) \
    [](auto& r) -> auto& { return r.member; }  // NOLINT(bugprone-macro-parentheses): a member cannot stand in them

std::vector<Field> hair_fields() {
    using T = TransmittanceMethod;
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
        choice<T>("transmittance.method",
                  {{"volume", T::volume}, {"opacity_maps", T::opacity_maps}, {"trace", T::trace}},
                  AT(transmittance.method)),
        integer("transmittance.directions", AT(transmittance.directions)),
        choice<D>("transmittance.direction_set",
                  {{"fibonacci", D::fibonacci}, {"stratified", D::stratified}, {"random", D::random}},
                  AT(transmittance.direction_set)),
        integer("transmittance.seed", AT(transmittance.seed)),
        integer("transmittance.voxels", AT(transmittance.voxels)),
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

std::vector<Field> make_fields() {
    std::vector<Field> fields;
    for (auto block : {hair_fields, fiber_fields, environment_fields, irradiance_fields})
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

void set_at(Json& object, const std::string& path, Json value) {
    std::string pointer = "/" + path;
    std::replace(pointer.begin(), pointer.end(), '.', '/');
    object[Json::json_pointer(pointer)] = std::move(value);
}

}  // namespace hairbake
