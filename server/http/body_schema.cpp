#include "server/http/body_schema.h"

#include <algorithm>
#include <locale>
#include <map>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "core/base/json_nesting.h"
#include "server/http/openapi.h"
#include "server/http/replies.h"
#include "server/jobs/service.h"

namespace hairbake {
namespace {

using Json = nlohmann::json;
using Adapter = valijson::adapters::NlohmannJsonAdapter;
constexpr int deepest = 16;  // levels of a request; later parsers recurse no deeper
constexpr std::size_t longest_value = 60, longest_schema = 600;

struct BodySchema {
    Json json;
    valijson::Schema parsed;
};

/// valijson makes a std::regex for every pattern, and libstdc++'s regex fills a cache of the locale without a lock. This
/// fills the cache in advance, so that threads only read it.
void fill_narrow_cache() {
    const auto& characters = std::use_facet<std::ctype<char>>(std::locale());
    for (int c = 1; c < 256; ++c) characters.narrow(static_cast<char>(c), 0);
}

/// The schemas of bodies. Other schemas of the document hold references, which valijson would have to resolve.
std::map<std::string, BodySchema> read_schemas() {
    fill_narrow_cache();
    std::map<std::string, BodySchema> schemas;
    const Json document = Json::parse(openapi());
    for (const auto& [name, json] : document.at("components").at("schemas").items()) {
        if (!name.ends_with("Request")) continue;
        BodySchema& schema = schemas[name];
        schema.json = json;
        valijson::SchemaParser(valijson::SchemaParser::kDraft7).populateSchema(Adapter(schema.json), schema.parsed);
    }
    return schemas;
}

Json parse(const std::string& text) {
    if (nested_deeper_than(text, deepest)) throw Refusal(Refused::malformed, "the body is nested too deeply");
    try {
        return Json::parse(text);
    } catch (const Json::exception& error) {
        throw Refusal(Refused::malformed, std::string("the body is not JSON: ") + error.what());
    }
}

std::string shortened(const std::string& text, std::size_t length) {
    return text.size() <= length ? text : text.substr(0, length) + "...";
}

/// The place of the first error, found by walking from the root. `schema` is null when it is ambiguous.
struct Place {
    Json::json_pointer pointer;
    std::string field;  ///< "irradiance.lights[0].direction"
    const Json* schema;

    void enter(const std::string& name) {
        pointer /= name;
        field += (field.empty() ? "" : ".") + name;
        schema = child("properties", name);
    }
    void enter(std::size_t index) {
        pointer /= index;
        field += "[" + std::to_string(index) + "]";
        schema = schema && schema->contains("items") ? &schema->at("items") : nullptr;
    }

private:
    const Json* child(const char* group, const std::string& name) const {
        return schema && schema->contains(group) && schema->at(group).contains(name) ? &schema->at(group).at(name)
                                                                                     : nullptr;
    }
};

/// valijson names a place as ["<root>", "[irradiance]", "[lights]", "[0]"].
Place place_of(const std::vector<std::string>& context, const Json& body, const Json& schema) {
    Place place{Json::json_pointer(), {}, &schema};
    for (std::size_t i = 1; i < context.size(); ++i) {
        const std::string inner = context[i].substr(1, context[i].size() - 2);
        if (body.at(place.pointer).is_array())
            place.enter(static_cast<std::size_t>(std::stoul(inner)));
        else
            place.enter(inner);
    }
    return place;
}

[[noreturn]] void refuse(const Place& place, const std::string& words) {
    throw Refusal(Refused::unprocessable, words, place.field).at(place.pointer.to_string());
}

/// Refuses an object with an unknown field or without a required one; else returns.
void refuse_names(Place place, const Json& object) {
    const Json properties = place.schema->value("properties", Json::object());
    if (place.schema->value("additionalProperties", Json(true)) == Json(false))
        for (const auto& [name, value] : object.items()) {
            if (properties.contains(name)) continue;
            std::string allowed;
            for (const auto& [known, schema] : properties.items()) allowed += (allowed.empty() ? "" : ", ") + known;
            place.enter(shortened(name, longest_value));
            refuse(place, place.field + " is not a field; allowed are " + allowed);
        }
    for (const Json& name : place.schema->value("required", Json::array()))
        if (!object.contains(name)) {
            place.enter(name.get<std::string>());
            refuse(place, place.field + " is missing");
        }
}

/// The constraints of a schema as text, and its description.
std::string allowed_by(Json schema) {
    const std::string description = schema.value("description", "");
    for (const char* word : {"properties", "description", "title", "default"}) schema.erase(word);
    return shortened(schema.dump(), longest_schema) + (description.empty() ? "" : ": " + description);
}

[[noreturn]] void explain(const valijson::ValidationResults& results, const Json& body, const Json& schema) {
    const Place place = place_of(results.begin()->context, body, schema);
    const Json found = body.contains(place.pointer) ? body.at(place.pointer) : Json();
    if (place.schema && found.is_object()) refuse_names(place, found);
    const std::string name = place.field.empty() ? "the body" : place.field;
    const std::string value = shortened(found.dump(-1, ' ', false, Json::error_handler_t::replace), longest_value);
    refuse(place, name + " is " + value + "; allowed is " +
                      (place.schema ? allowed_by(*place.schema) : "described by /openapi.json"));
}

}  // namespace

void check_json(const std::string& text, const std::string& name) {
    static const std::map<std::string, BodySchema> schemas = read_schemas();
    const BodySchema& schema = schemas.at(name);
    const Json body = parse(text);
    valijson::ValidationResults results;
    valijson::Validator validator(valijson::Validator::kStrongTypes);
    if (!validator.validate(schema.parsed, Adapter(body), &results)) explain(results, body, schema.json);
}

std::string read_json(const HttpRequest& request, const std::string& schema) {
    std::string text = read_text(request);
    check_json(text, schema);
    return text;
}

}  // namespace hairbake
