#include "server/http/openapi.h"

#include <nlohmann/json.hpp>

#include "core/request/request_presets.h"
#include "server/http/embedded.h"
#include "server/jobs/bake_request.h"

namespace hairbake {
namespace {

using Json = nlohmann::ordered_json;

/// The request's schema with the differences between HTTP and the command line.
Json bake_request_schema() {
    Json schema = Json::parse(request_schema());
    schema.erase("$schema");
    Json& properties = schema["properties"];
    properties["priority"] = {{"description", "Bakes of a higher priority are started first."},
                              {"type", "integer"},
                              {"minimum", -10},
                              {"maximum", 10},
                              {"default", 0}};
    properties["environment"]["description"] =
        "HDR environment, sha256:... or name:...: one picture, lat-long or a cube's faces as a cross or a strip. Six "
        "files of faces are for the command line; here, send them as one cross or strip.";
    return schema;
}

}  // namespace

std::string openapi() {
    Json document = Json::parse(openapi_document());
    Json& schemas = document["components"]["schemas"];
    schemas["BakeRequest"] = bake_request_schema();
    for (const std::string& block : lighting_blocks())
        schemas["RebakeRequest"]["properties"][block] = schemas["BakeRequest"]["properties"][block];
    Json& bake = document["paths"]["/v1/bakes"]["post"]["requestBody"]["content"]["application/json"];
    for (const Preset& preset : presets()) {
        const std::string name(preset.name);
        document["components"]["examples"][name] = {{"summary", preset_description(preset)},
                                                    {"value", Json::parse(preset.json).at("request")}};
        bake["examples"][name] = {{"$ref", "#/components/examples/" + name}};
    }
    return document.dump(1);
}

}  // namespace hairbake
