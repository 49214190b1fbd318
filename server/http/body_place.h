// A place in a JSON body with its schema, and the messages of the refusals that name it.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>

#include "server/jobs/service.h"

namespace hairbake {

/// For one thread. It is entered step by step from the root of the body.
class BodyPlace {
public:
    using Json = nlohmann::json;

    /// `schema` outlives this object.
    explicit BodyPlace(const Json& schema) : schema_(&schema) {}

    void enter(const std::string& name);
    void enter(std::size_t index);

    const Json::json_pointer& pointer() const { return pointer_; }
    const std::string& field() const { return field_; }  ///< "irradiance.lights[0].direction"
    const Json* schema() const { return schema_; }       ///< null where the schema does not name the place

    /// Throws Refusal(unprocessable): "FIELD is FOUND; allowed is" with the constraints of the schema. `found` is JSON.
    [[noreturn]] void refuse_value(const std::string& found) const;
    /// Throws Refusal(unprocessable): "FIELD is not a field; allowed are" with the fields that the place may have.
    [[noreturn]] void refuse_unknown(const std::string& name) const;
    /// Throws Refusal with these words after the field.
    [[noreturn]] void refuse(const std::string& words, Refused why = Refused::unprocessable) const;

private:
    std::string name() const;

    Json::json_pointer pointer_;
    std::string field_;
    const Json* schema_;
};

/// Whether the schema knows all fields of an object.
bool is_closed(const BodyPlace::Json* schema);

/// The schema of the object's field or of the list's items. Null when the schema does not name it.
const BodyPlace::Json* schema_of_field(const BodyPlace::Json* schema, const std::string& name);
const BodyPlace::Json* schema_of_items(const BodyPlace::Json* schema);

}  // namespace hairbake
