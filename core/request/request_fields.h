// The request's fields one by one, each with its JSON form. Private to core/request.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/request/request.h"

namespace hairbake {

/// One field of the request.
struct RequestField {
    using Json = nlohmann::ordered_json;
    std::string path;  ///< dotted: "transmittance.opacity_maps.layers"
    std::function<Json(const BakeRequest&)> get;
    std::function<void(BakeRequest&, const Json&)> set;  ///< throws Error(usage) for a value of the wrong type

    /// The place of the field in the first version of hairbake, if elsewhere. Requests may still name it there. The
    /// text that keys are made of always has it there, so a field that moves changes no key.
    std::string first_path = {};
    /// For a field that came after the first version: the value with which hairbake behaves as the first version did.
    /// Keys leave the field out at this value, so a field that is added changes no key.
    std::optional<Json> first_value = {};
};

/// All fields, in the order of the documentation.
const std::vector<RequestField>& request_fields();

/// The field of this path, or of this path in the first version; null where there is none.
const RequestField* find_field(const std::string& path);

/// Whether the field of this path stands in the block: "transmittance.voxels" in "transmittance".
bool in_block(std::string_view path, std::string_view block);

/// Whether the path is that of the field or block, or stands in it.
bool is_or_lies_in(std::string_view path, std::string_view field_or_block);

/// Sets `value` into `object` at a dotted path, and makes the objects on the way.
void set_at(RequestField::Json& object, const std::string& path, RequestField::Json value);

/// Throws the Error(usage) for a value of the wrong type: `path`, what was found, what is allowed.
[[noreturn]] void refuse_value(const std::string& path, const RequestField::Json& found, const std::string& allowed);

}  // namespace hairbake
