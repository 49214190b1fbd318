#include "server/http/body_place.h"

#include "core/base/short_text.h"

namespace hairbake {
namespace {

using Json = BodyPlace::Json;
constexpr std::size_t longest_value = 60, longest_schema = 600;

/// The constraints of a schema as text, and its description.
std::string allowed_by(Json schema) {
    const std::string description = schema.value("description", "");
    for (const char* word : {"properties", "description", "title", "default"}) schema.erase(word);
    return shortened(schema.dump(), longest_schema) + (description.empty() ? "" : ": " + description);
}

}  // namespace

void BodyPlace::enter(const std::string& name) {
    pointer_ /= name;
    field_ += (field_.empty() ? "" : ".") + (name.empty() ? "\"\"" : name);
    schema_ = schema_of_field(schema_, name);
}

void BodyPlace::enter(std::size_t index) {
    pointer_ /= index;
    field_ += "[" + std::to_string(index) + "]";
    schema_ = schema_of_items(schema_);
}

std::string BodyPlace::name() const { return field_.empty() ? "the body" : field_; }

void BodyPlace::refuse(const std::string& words, Refused why) const {
    throw Refusal(why, name() + " " + words, field_).at(pointer_.to_string());
}

void BodyPlace::refuse_value(const std::string& found) const {
    refuse("is " + shortened(found, longest_value) + "; allowed is " +
           (schema_ ? allowed_by(*schema_) : "described by /openapi.json"));
}

void BodyPlace::refuse_unknown(const std::string& name) const {
    std::string allowed;
    const Json properties = schema_ ? schema_->value("properties", Json::object()) : Json::object();
    for (const auto& [known, schema] : properties.items()) allowed += (allowed.empty() ? "" : ", ") + known;
    BodyPlace place = *this;
    place.enter(shortened(name, longest_value));
    place.refuse("is not a field; allowed are " + allowed);
}

bool is_closed(const Json* schema) {
    return schema && schema->value("additionalProperties", Json(true)) == Json(false);
}

const Json* schema_of_field(const Json* schema, const std::string& name) {
    if (!schema) return nullptr;
    const auto fields = schema->find("properties");
    if (fields == schema->end()) return nullptr;
    const auto field = fields->find(name);
    return field == fields->end() ? nullptr : &*field;
}

const Json* schema_of_items(const Json* schema) {
    if (!schema) return nullptr;
    const auto items = schema->find("items");
    return items == schema->end() ? nullptr : &*items;
}

}  // namespace hairbake
