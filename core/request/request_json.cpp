#include "core/request/request_json.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <utility>

#include "core/base/error.h"
#include "core/base/json_nesting.h"
#include "core/base/json_reason.h"
#include "core/base/number_text.h"
#include "core/base/spelling.h"
#include "core/request/request_fields.h"

namespace hairbake {
namespace {

using Json = RequestField::Json;

bool is_block(const std::string& path) {
    for (const RequestField& field : request_fields())
        if (field.path.starts_with(path + ".")) return true;
    return false;
}

/// Names that may stand in the object `block` ("" for the request itself): "width, width_scale, opacity".
std::string names_in(const std::string& block) {
    const std::string prefix = block.empty() ? "" : block + ".";
    std::string list, last;
    for (const RequestField& field : request_fields()) {
        if (!field.path.starts_with(prefix)) continue;
        const std::string name = field.path.substr(prefix.size(), field.path.find('.', prefix.size()) - prefix.size());
        if (name != last) list += (list.empty() ? "" : ", ") + name;
        last = name;
    }
    return list;
}

/// " (did you mean transmittance.voxels?)" for "voxels", "transmittance.voxel" and the like; empty where nothing is
/// close.
std::string suggestion(const std::string& path) {
    const std::vector<std::string> paths = field_paths();
    for (const std::string& known : paths)
        if (known.ends_with("." + path)) return " (did you mean " + known + "?)";
    return did_you_mean(path, paths);
}

[[noreturn]] void refuse_unknown(const std::string& path) {
    const std::size_t dot = path.rfind('.');
    const std::string block = dot == std::string::npos ? "" : path.substr(0, dot);
    const bool known_block = block.empty() || is_block(block);
    throw Error(ErrorKind::usage,
                path + " is not a field of the request" + suggestion(path) + "; allowed are " +
                    (known_block && !block.empty() ? "in " + block + ": " + names_in(block) : names_in("")),
                path);
}

/// "irradiance.tint is deprecated; ...": empty for a field at its own place.
std::string deprecation(const RequestField& field, const std::string& path) {
    return field.path == path ? "" : path + " is deprecated: the field is now " + field.path;
}

/// Sets the field from `path`, which may be its place in the first version; errors then name that place.
void set_from(const RequestField& field, const std::string& path, BakeRequest& request, const Json& value) {
    if (field.path == path) return field.set(request, value);
    try {
        field.set(request, value);
    } catch (const Error& error) {
        std::string message = error.what(), name = error.field();
        if (message.starts_with(field.path)) message.replace(0, field.path.size(), path);
        if (name.starts_with(field.path)) name.replace(0, field.path.size(), path);
        throw Error(error.kind(), message, name);
    }
}

/// Merges JSON objects into a request.
class Merge {
public:
    explicit Merge(BakeRequest& request) : request_(request) {}

    void object(const Json& object, const std::string& block) {
        if (!object.is_object()) refuse_value(block.empty() ? "the request" : block, object, "an object");
        for (const auto& [name, value] : object.items()) {
            const std::string path = block.empty() ? name : block + "." + name;
            const bool dotted = name.find('.') != std::string::npos;  // paths are for --set alone
            const RequestField* field = find_field(path);
            if (dotted || (!field && !is_block(path))) refuse_unknown(path);
            if (field)
                set(*field, path, value);
            else
                this->object(value, path);
        }
    }

    std::vector<std::string> warnings;

private:
    void set(const RequestField& field, const std::string& path, const Json& value) {
        if (!set_.insert(&field).second)
            throw Error(ErrorKind::usage,
                        field.path + " is given twice, also as " + field.first_path + "; allowed is once", path);
        set_from(field, path, request_, value);
        if (std::string warning = deprecation(field, path); !warning.empty()) warnings.push_back(std::move(warning));
    }

    BakeRequest& request_;
    std::set<const RequestField*> set_;
};

/// Reads `text` as JSON, as a number that JSON does not know (".05", "1.", "+5"), or as plain text. `path` is the field
/// that gets the value.
Json json_or_text(const std::string& text, const std::string& path) {
    Json value = Json::parse(text, nullptr, false);
    if (value.is_discarded()) {
        const std::optional<double> number = number_of(text);
        return number ? Json(*number) : Json(text);
    }
    check_nesting(text, path, ErrorKind::usage, path);
    return value;
}

Json list_of(const std::string& text, const std::string& path) {
    Json list = Json::array();
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        if (end > begin) list.push_back(json_or_text(text.substr(begin, end - begin), path));
        begin = end + 1;
    }
    return list;
}

}  // namespace

std::string to_json(const BakeRequest& request, int indent) {
    Json object = Json::object();
    for (const RequestField& field : request_fields()) set_at(object, field.path, field.get(request));
    return object.dump(indent, ' ', false, Json::error_handler_t::replace);
}

std::vector<std::string> merge_json(BakeRequest& request, std::string_view text, const std::string& source) {
    check_nesting(text, source, ErrorKind::usage);
    BakeRequest merged = request;
    Merge merge(merged);
    try {
        merge.object(Json::parse(text), "");
    } catch (const Json::exception& error) {
        throw Error(ErrorKind::usage, source + " is not JSON: " + json_reason(error));
    } catch (const Error& error) {
        throw Error(error.kind(), source + ": " + error.what(), error.field());
    }
    request = std::move(merged);
    for (std::string& warning : merge.warnings) warning = source + ": " + warning;
    return std::move(merge.warnings);
}

std::vector<std::string> set_field(BakeRequest& request, const std::string& path, const std::string& value) {
    const RequestField* field = find_field(path);
    if (!field && is_block(path))
        throw Error(ErrorKind::usage, path + " is a block; set one of its fields: " + names_in(path), path);
    if (!field) refuse_unknown(path);

    Json parsed = json_or_text(value, path);
    const Json current = field->get(request);
    if (current.is_array() && !parsed.is_array()) parsed = list_of(value, path);
    if (path == "hair" || path == "environment" || path == "occluder" || path == "receiver")
        if (!parsed.is_null()) parsed = value;  // a file may be called 12 or true
    BakeRequest changed = request;
    set_from(*field, path, changed, parsed);
    request = std::move(changed);
    std::string warning = deprecation(*field, path);
    return warning.empty() ? std::vector<std::string>() : std::vector{std::move(warning)};
}

std::string first_place_of(const std::string& path) {
    const RequestField* field = find_field(path);
    return field ? field->first_path : std::string();
}

std::vector<std::string> field_paths() {
    std::vector<std::string> paths;
    for (const RequestField& field : request_fields()) paths.push_back(field.path);
    return paths;
}

}  // namespace hairbake
