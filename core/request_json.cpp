#include "core/request_json.h"

#include <cmath>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/base/error.h"

namespace hairbake {
namespace {

using Json = nlohmann::ordered_json;

/// One field of the request. `path` is dotted; `set` throws Error(usage) for a value of the wrong type.
struct Field {
    std::string path;
    std::function<Json(const BakeRequest&)> get;
    std::function<void(BakeRequest&, const Json&)> set;
};

[[noreturn]] void refuse(const std::string& path, const Json& found, const std::string& allowed) {
    std::string shown = found.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (shown.size() > 60) shown = shown.substr(0, 57) + "...";
    throw Error(ErrorKind::usage, path + " is " + shown + "; allowed is " + allowed, path);
}

// ---- values ------------------------------------------------------------------------------------------------------

double read_number(const std::string& path, const Json& value, const std::string& allowed = "a number") {
    if (!value.is_number() || !std::isfinite(value.get<double>())) refuse(path, value, allowed);
    return value.get<double>();
}

/// 100 and 100.0 are both the integer 100, as in JSON Schema.
template <class Integer>
Integer read_integer(const std::string& path, const Json& value, const std::string& allowed = "an integer") {
    const double number = read_number(path, value, allowed);
    const double high = std::min(0x1p53, static_cast<double>(std::numeric_limits<Integer>::max()));
    const double low = std::max(-0x1p53, static_cast<double>(std::numeric_limits<Integer>::lowest()));
    if (number != std::floor(number) || !(number >= low && number <= high)) refuse(path, value, allowed);
    return static_cast<Integer>(number);
}

std::string read_string(const std::string& path, const Json& value, const std::string& allowed = "a string") {
    if (!value.is_string()) refuse(path, value, allowed);
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
                if (!v.is_boolean()) refuse(path, v, "true or false");
                at(r) = v.template get<bool>();
            }};
}

template <class At>
Field string(std::string path, At at) {
    return {path, [at](const BakeRequest& r) { return Json(at(r)); },
            [=](BakeRequest& r, const Json& v) { at(r) = read_string(path, v); }};
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
                if (!v.is_array() || v.size() != 3) refuse(path, v, "a list of three numbers");
                for (std::size_t i = 0; i < 3; ++i) at(r)[i] = read_number(path, v[i]);
            }};
}

template <class At>
Field string_list(std::string path, At at) {
    return {path, [at](const BakeRequest& r) { return Json(at(r)); },
            [=](BakeRequest& r, const Json& v) {
                if (!v.is_array()) refuse(path, v, "a list of strings");
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
                refuse(path, v, allowed);
            }};
}

Field opacity(std::string path) {
    return {
        path,
        [](const BakeRequest& r) { return r.strand.opacity_from_file ? Json("from_file") : Json(r.strand.opacity); },
        [=](BakeRequest& r, const Json& v) {
            r.strand.opacity_from_file = v == "from_file";
            r.strand.opacity =
                r.strand.opacity_from_file ? 1 : read_number(path, v, "a number from 0 to 1 or \"from_file\"");
        }};
}

/// A field of a later version: known by name, accepted with its neutral value alone.
Field later(std::string path, Json neutral) {
    return {path, [=](const BakeRequest&) { return neutral; },
            [=](BakeRequest&, const Json& v) {
                if (v != neutral) refuse(path, v, "only " + neutral.dump() + " in this version of hairbake");
            }};
}

// ---- the request, field by field -----------------------------------------------------------------------------------

#define AT(member) \
    [](auto& r) -> auto& { return r.member; }

std::vector<Field> make_fields() {
    using T = TransmittanceMethod;
    using D = DirectionSet;
    using I = IrradianceMethod;
    return {
        optional_string("hair", AT(hair)),
        optional_string("environment", AT(environment)),
        later("occluder", nullptr),
        later("receiver", nullptr),
        optional_number("strand.width", AT(strand.width)),
        number("strand.width_scale", AT(strand.width_scale)),
        opacity("strand.opacity"),
        choice<T>("transmittance.method", {{"volume", T::volume}, {"trace", T::trace}}, AT(transmittance.method)),
        integer("transmittance.directions", AT(transmittance.directions)),
        choice<D>("transmittance.direction_set",
                  {{"fibonacci", D::fibonacci}, {"stratified", D::stratified}, {"random", D::random}},
                  AT(transmittance.direction_set)),
        integer("transmittance.seed", AT(transmittance.seed)),
        integer("transmittance.voxels", AT(transmittance.voxels)),
        optional_number("transmittance.voxel_size", AT(transmittance.voxel_size)),
        later("transmittance.sh_bands", 0),
        later("transmittance.bent_cone", false),
        integer("transmittance.reference_vertices", AT(transmittance.reference_vertices)),
        string("irradiance.model", AT(irradiance.model)),
        integer("irradiance.face_size", AT(irradiance.face_size)),
        integer("irradiance.specular_maps", AT(irradiance.specular_maps)),
        number("irradiance.exponent", AT(irradiance.exponent)),
        choice<I>("irradiance.method", {{"exact", I::exact}, {"sh", I::sh}}, AT(irradiance.method)),
        integer_or_auto("irradiance.sh_bands.diffuse", AT(irradiance.sh_bands_diffuse)),
        integer_or_auto("irradiance.sh_bands.specular", AT(irradiance.sh_bands_specular)),
        number("irradiance.sh_error", AT(irradiance.sh_error)),
        boolean("irradiance.clamp_negative", AT(irradiance.clamp_negative)),
        string("irradiance.layout", AT(environment_settings.layout)),
        choice<LatLong>("irradiance.latlong",
                        {{"gltf", LatLong::gltf}, {"filament", LatLong::filament}, {"openexr", LatLong::openexr}},
                        AT(environment_settings.latlong)),
        triple("irradiance.rotation_deg", AT(environment_settings.rotation_deg)),
        number("irradiance.exposure_stops", AT(environment_settings.exposure_stops)),
        triple("irradiance.tint", AT(environment_settings.tint)),
        later("irradiance.lights", Json::array()),
        choice<InvalidRadiance>("irradiance.invalid_radiance",
                                {{"reject", InvalidRadiance::reject}, {"clamp", InvalidRadiance::clamp}},
                                AT(environment_settings.invalid_radiance)),
        string_list("outputs", AT(outputs)),
    };
}
#undef AT

const std::vector<Field>& fields() {
    static const std::vector<Field> table = make_fields();
    return table;
}

const Field* find_field(const std::string& path) {
    for (const Field& field : fields())
        if (field.path == path) return &field;
    return nullptr;
}

bool is_block(const std::string& path) {
    for (const Field& field : fields())
        if (field.path.starts_with(path + ".")) return true;
    return false;
}

/// Names that may stand in the object `block` ("" for the request itself): "width, width_scale, opacity".
std::string names_in(const std::string& block) {
    const std::string prefix = block.empty() ? "" : block + ".";
    std::string list, last;
    for (const Field& field : fields()) {
        if (!field.path.starts_with(prefix)) continue;
        const std::string name = field.path.substr(prefix.size(), field.path.find('.', prefix.size()) - prefix.size());
        if (name != last) list += (list.empty() ? "" : ", ") + name;
        last = name;
    }
    return list;
}

[[noreturn]] void refuse_unknown(const std::string& path) {
    const std::size_t dot = path.rfind('.');
    const std::string block = dot == std::string::npos ? "" : path.substr(0, dot);
    const bool known_block = block.empty() || is_block(block);
    throw Error(ErrorKind::usage,
                path + " is not a field of the request; allowed are " +
                    (known_block && !block.empty() ? "in " + block + ": " + names_in(block) : names_in("")),
                path);
}

void merge_object(BakeRequest& request, const Json& object, const std::string& block) {
    if (!object.is_object()) refuse(block.empty() ? "the request" : block, object, "an object");
    for (const auto& [name, value] : object.items()) {
        const std::string path = block.empty() ? name : block + "." + name;
        const bool dotted = name.find('.') != std::string::npos;  // paths are for --set alone
        const Field* field = find_field(path);
        if (dotted || (!field && !is_block(path))) refuse_unknown(path);
        if (field)
            field->set(request, value);
        else
            merge_object(request, value, path);
    }
}

Json to_object(const BakeRequest& request) {
    Json object = Json::object();
    for (const Field& field : fields()) {
        std::string pointer = "/" + field.path;
        for (char& c : pointer)
            if (c == '.') c = '/';
        object[Json::json_pointer(pointer)] = field.get(request);
    }
    return object;
}

Json json_or_text(const std::string& text) {
    Json value = Json::parse(text, nullptr, false);
    return value.is_discarded() ? Json(text) : value;
}

Json list_of(const std::string& text) {
    Json list = Json::array();
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        if (end > begin) list.push_back(json_or_text(text.substr(begin, end - begin)));
        begin = end + 1;
    }
    return list;
}

}  // namespace

std::string to_json(const BakeRequest& request, int indent) {
    return to_object(request).dump(indent, ' ', false, Json::error_handler_t::replace);
}

void merge_json(BakeRequest& request, std::string_view text, const std::string& source) {
    BakeRequest merged = request;
    try {
        merge_object(merged, Json::parse(text), "");
    } catch (const Json::exception& error) {
        throw Error(ErrorKind::usage, source + " is not JSON: " + error.what());
    } catch (const Error& error) {
        throw Error(error.kind(), source + ": " + error.what(), error.field());
    }
    request = std::move(merged);
}

void set_field(BakeRequest& request, const std::string& path, const std::string& value) {
    const Field* field = find_field(path);
    if (!field && is_block(path))
        throw Error(ErrorKind::usage, path + " is a block; set one of its fields: " + names_in(path), path);
    if (!field) refuse_unknown(path);

    Json parsed = json_or_text(value);
    const Json current = field->get(request);
    if (current.is_array() && !parsed.is_array()) parsed = list_of(value);
    if (path == "hair" || path == "environment")
        if (!parsed.is_null()) parsed = value;  // a file may be called 12 or true
    BakeRequest changed = request;
    field->set(changed, parsed);
    request = std::move(changed);
}

std::vector<std::string> field_paths() {
    std::vector<std::string> paths;
    for (const Field& field : fields()) paths.push_back(field.path);
    return paths;
}

std::string canonical_transmittance_settings(const BakeRequest& request) {
    const Json all = to_object(request);
    const nlohmann::json sorted = {{"occluder", all["occluder"]},
                                   {"receiver", all["receiver"]},
                                   {"strand", all["strand"]},
                                   {"transmittance", all["transmittance"]}};
    return sorted.dump();
}

std::string canonical_irradiance_settings(const BakeRequest& request) {
    return nlohmann::json(to_object(request)["irradiance"]).dump();
}

}  // namespace hairbake
