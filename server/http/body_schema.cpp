#include "server/http/body_schema.h"

#include <locale>
#include <map>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "server/http/body_place.h"
#include "server/http/body_shape.h"
#include "server/http/openapi.h"

namespace hairbake {
namespace {

using Json = nlohmann::json;
using Adapter = valijson::adapters::NlohmannJsonAdapter;

struct BodySchema {
    Json json;
    valijson::Schema parsed;
};

/// valijson makes a std::regex for every pattern, and libstdc++'s regex fills a cache of the locale without a lock.
/// This fills the cache in advance, so that threads only read it.
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

/// valijson names a place as ["<root>", "[irradiance]", "[lights]", "[0]"].
BodyPlace place_of(const std::vector<std::string>& context, const Json& body, const Json& schema) {
    BodyPlace place(schema);
    for (std::size_t i = 1; i < context.size(); ++i) {
        const std::string inner = context[i].substr(1, context[i].size() - 2);
        if (body.at(place.pointer()).is_array())
            place.enter(static_cast<std::size_t>(std::stoul(inner)));
        else
            place.enter(inner);
    }
    return place;
}

/// Refuses an object without a required field; else returns.
void refuse_missing(BodyPlace place, const Json& object) {
    for (const Json& name : place.schema()->value("required", Json::array()))
        if (!object.contains(name)) {
            place.enter(name.get<std::string>());
            place.refuse("is missing");
        }
}

[[noreturn]] void explain(const valijson::ValidationResults& results, const Json& body, const Json& schema) {
    const BodyPlace place = place_of(results.begin()->context, body, schema);
    const Json found = body.contains(place.pointer()) ? body.at(place.pointer()) : Json();
    if (place.schema() && found.is_object()) refuse_missing(place, found);
    place.refuse_value(found.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace

void check_json(const std::string& text, const std::string& name) {
    static const std::map<std::string, BodySchema> schemas = read_schemas();
    const BodySchema& schema = schemas.at(name);
    check_shape(text, schema.json);
    const Json body = Json::parse(text);
    valijson::Validator validator(valijson::Validator::kStrongTypes);
    if (validator.validate(schema.parsed, Adapter(body), nullptr)) return;  // ends at its first error
    valijson::ValidationResults results;  // few: check_shape() has bounded the lists and found errors of long ones
    validator.validate(schema.parsed, Adapter(body), &results);
    explain(results, body, schema.json);
}

}  // namespace hairbake
