#include "core/request/field_facts.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/short_number.h"
#include "core/request/request_fields.h"
#include "core/request/request_presets.h"

namespace hairbake {
namespace {

using Json = RequestField::Json;

std::string list_of(const Json& values) {
    std::string list;
    for (const Json& value : values) list += (list.empty() ? "" : ", ") + value.get<std::string>();
    return list;
}

bool is_of_type(const Json& property, const std::string& type) {
    const Json& found = property.value("type", Json());
    return found == type || (found.is_array() && std::find(found.begin(), found.end(), type) != found.end());
}

std::string range_of(const Json& property) {
    const std::string high = short_number(property.at("maximum").get<double>());
    if (property.contains("exclusiveMinimum"))
        return "above " + short_number(property["exclusiveMinimum"].get<double>()) + ", up to " + high;
    return short_number(property.at("minimum").get<double>()) + " to " + high;
}

std::string items_of(const Json& property) {
    const Json& item = property.at("items");
    if (item.contains("enum")) return "a list of " + list_of(item["enum"]);
    const std::string most = std::to_string(property.at("maxItems").get<int>());
    if (item.contains("maximum")) return most + " numbers, each " + range_of(item);
    std::string members;
    for (const auto& [name, member] : item.at("properties").items()) members += (members.empty() ? "" : ", ") + name;
    return "a list of up to " + most + " objects of " + members;
}

/// What the property of the schema allows. null is the default of fields that allow it.
std::string allowed_by(const Json& property) {
    if (property.contains("anyOf")) {
        std::string text;
        for (const Json& one : property["anyOf"]) text += (text.empty() ? "" : " or ") + allowed_by(one);
        return text;
    }
    if (property.contains("const")) return property["const"].get<std::string>();
    if (property.contains("enum")) return (property["enum"].size() > 1 ? "one of " : "") + list_of(property["enum"]);
    if (is_of_type(property, "boolean")) return "true or false";
    if (is_of_type(property, "array")) return items_of(property);
    if (is_of_type(property, "string")) return "a path";
    return range_of(property);
}

std::string default_of(const Json& property) {
    const Json& value = property.at("default");
    if (value.is_null()) return "none";
    if (value.is_string()) return value.get<std::string>();
    if (value.is_number()) return short_number(value.get<double>());
    if (!value.is_array()) return value.dump();
    std::string list;
    for (const Json& item : value)
        list += (list.empty() ? "" : ",") + (item.is_string() ? item.get<std::string>() : item.dump());
    return list.empty() ? "none" : list;
}

/// The property of the schema at a dotted path.
const Json& property_at(const Json& schema, const std::string& path) {
    const Json* at = &schema;
    for (std::size_t begin = 0; begin <= path.size();) {
        const std::size_t end = std::min(path.find('.', begin), path.size());
        at = &at->at("properties").at(path.substr(begin, end - begin));
        begin = end + 1;
    }
    return *at;
}

/// The words that the property allows; of a list, those of its items.
std::vector<std::string> words_of(const Json& property) {
    std::vector<std::string> words;
    const auto add = [&](const std::vector<std::string>& more) { words.insert(words.end(), more.begin(), more.end()); };
    for (const Json& one : property.value("anyOf", Json::array())) add(words_of(one));
    for (const Json& one : property.value("enum", Json::array())) add({one.get<std::string>()});
    if (property.contains("const")) add({property["const"].get<std::string>()});
    if (is_of_type(property, "boolean")) add({"true", "false"});
    if (is_of_type(property, "array") && property.contains("items")) add(words_of(property["items"]));
    return words;
}

FieldFacts facts_in(const Json& schema, const std::string& path) {
    const Json& property = property_at(schema, path);
    return {path,
            property.value("x-unit", ""),
            allowed_by(property),
            default_of(property),
            property.value("description", ""),
            words_of(property),
            is_of_type(property, "array")};
}

}  // namespace

std::vector<FieldFacts> field_facts() {
    const Json schema = Json::parse(request_schema());
    std::vector<FieldFacts> facts;
    for (const RequestField& field : request_fields()) facts.push_back(facts_in(schema, field.path));
    return facts;
}

FieldFacts facts_of_field(const std::string& path) { return facts_in(Json::parse(request_schema()), path); }

std::string range_text(const FieldFacts& facts) {
    return facts.allowed + (facts.unit.empty() ? "" : " (" + facts.unit + ")") + "; default " + facts.standard;
}

}  // namespace hairbake
