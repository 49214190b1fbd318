// The published schema and the code that reads requests must say the same.
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/request/request_json.h"
#include "core/request/request_presets.h"

namespace hairbake {
namespace {

using Json = nlohmann::ordered_json;

void collect(const Json& object, const std::string& prefix, bool deprecated, std::map<std::string, Json>& found) {
    EXPECT_EQ(object.at("additionalProperties"), false) << prefix;
    for (const auto& [name, property] : object.at("properties").items()) {
        if (property.contains("properties"))
            collect(property, prefix + name + ".", deprecated, found);
        else if (property.value("deprecated", false) == deprecated)
            found[prefix + name] = property;
    }
}

/// Schema property of every field, by path; or of every deprecated place of a field.
std::map<std::string, Json> schema_fields(bool deprecated = false) {
    std::map<std::string, Json> found;
    collect(Json::parse(request_schema()), "", deprecated, found);
    return found;
}

bool accepted(const std::string& path, const Json& value) {
    Json object = value;
    for (std::string rest = path; !rest.empty();) {
        const std::size_t dot = rest.rfind('.');
        object = Json{{dot == std::string::npos ? rest : rest.substr(dot + 1), object}};
        rest = dot == std::string::npos ? "" : rest.substr(0, dot);
    }
    BakeRequest request;
    try {
        merge_json(request, object.dump(), "test");
        if (!request.hair && !(path == "environment" && request.environment)) request.hair = "a.hair";
        validate(request);
        return true;
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::usage);
        return false;
    }
}

/// The alternatives of a property: itself, or the members of its anyOf.
std::vector<Json> alternatives(const Json& property) {
    if (!property.contains("anyOf")) return {property};
    return {property["anyOf"].begin(), property["anyOf"].end()};
}

TEST(RequestSchema, NamesExactlyTheFieldsOfTheCode) {
    std::vector<std::string> in_schema;
    for (const auto& [path, property] : schema_fields()) in_schema.push_back(path);
    std::vector<std::string> in_code = field_paths();
    std::sort(in_code.begin(), in_code.end());
    EXPECT_EQ(in_schema, in_code);
}

TEST(RequestSchema, NamesTheDeprecatedPlacesThatTheCodeTakes) {
    const auto places = schema_fields(true);
    EXPECT_EQ(places.size(), 8u);
    const Json defaults = Json::parse(to_json(BakeRequest{}));
    for (const auto& [path, property] : places) {
        // "Deprecated: now fiber.model.": the place takes the value of that field, and the code warns of the place.
        const std::string words = property.at("description"), begin = "Deprecated: now ";
        ASSERT_TRUE(words.starts_with(begin) && words.ends_with(".")) << path;
        std::string pointer = "/" + words.substr(begin.size(), words.size() - begin.size() - 1);
        std::replace(pointer.begin(), pointer.end(), '.', '/');
        const Json value = defaults.at(Json::json_pointer(pointer));
        BakeRequest request;
        EXPECT_EQ(set_field(request, path, value.is_string() ? value.get<std::string>() : value.dump()).size(), 1u)
            << path;
        EXPECT_EQ(to_json(request), to_json(BakeRequest{}));
    }
}

TEST(RequestSchema, GivesTheDefaultsOfTheCode) {
    const Json defaults = Json::parse(to_json(BakeRequest{}));
    for (const auto& [path, property] : schema_fields()) {
        std::string pointer = "/" + path;
        std::replace(pointer.begin(), pointer.end(), '.', '/');
        ASSERT_TRUE(property.contains("default")) << path;
        EXPECT_EQ(property["default"], defaults.at(Json::json_pointer(pointer))) << path;
        if (path == "hair" || path == "environment") continue;  // one of the two is always given
        EXPECT_TRUE(accepted(path, property["default"])) << path;
    }
}

TEST(RequestSchema, EveryEnumerationAndConstantIsAcceptedAndNothingElse) {
    for (const auto& [path, property] : schema_fields())
        for (const Json& alternative : alternatives(property)) {
            if (alternative.contains("const")) {
                EXPECT_TRUE(accepted(path, alternative["const"])) << path;
            }
            if (!alternative.contains("enum")) continue;
            for (const Json& value : alternative["enum"]) EXPECT_TRUE(accepted(path, value)) << path << value;
            EXPECT_FALSE(accepted(path, "no such thing")) << path;
        }
}

TEST(RequestSchema, RangesEndWhereTheCodeEndsThem) {
    for (const auto& [path, property] : schema_fields()) {
        if (path == "irradiance.lights") continue;   // a list of objects: see request_test
        if (path == "transmittance.seed") continue;  // its ends are the ends of exact integers: see request_test
        for (const Json& alternative : alternatives(property)) {
            const bool triple = alternative.contains("items") && alternative.value("maxItems", 0) == 3;
            const Json& range = triple ? alternative["items"] : alternative;
            const auto value = [&](double v) { return triple ? Json{v, v, v} : Json(v); };
            const double step = range.contains("type") && range["type"] == "integer" ? 1 : 1e-7;
            const auto beyond = [&](double end) { return step * std::max(1.0, std::abs(end) * (step < 1 ? 1 : 0)); };
            if (range.contains("minimum")) {
                const double low = range["minimum"];
                EXPECT_TRUE(accepted(path, value(low))) << path;
                EXPECT_FALSE(accepted(path, value(low - beyond(low)))) << path;
            }
            if (range.contains("exclusiveMinimum")) {
                const double low = range["exclusiveMinimum"];
                EXPECT_FALSE(accepted(path, value(low))) << path;
                EXPECT_TRUE(accepted(path, value(low + beyond(low)))) << path;
            }
            if (range.contains("maximum")) {
                const double high = range["maximum"];
                EXPECT_TRUE(accepted(path, value(high))) << path;
                EXPECT_FALSE(accepted(path, value(high + beyond(high)))) << path;
            }
        }
    }
}

TEST(RequestSchema, NullIsAllowedWhereTheSchemaSaysSo) {
    for (const auto& [path, property] : schema_fields()) {
        bool nullable = property.contains("const") && property["const"].is_null();
        if (property.contains("type") && property["type"].is_array())
            for (const Json& type : property["type"]) nullable |= type == "null";
        EXPECT_EQ(accepted(path, nullptr), nullable) << path;
    }
}

}  // namespace
}  // namespace hairbake
