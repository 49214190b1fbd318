// The request's fields one by one, each with its JSON form. Used by request_json.cpp alone.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/request/request.h"

namespace hairbake {

/// One field of the request. `path` is dotted; `set` throws Error(usage) for a value of the wrong type.
struct RequestField {
    using Json = nlohmann::ordered_json;
    std::string path;
    std::function<Json(const BakeRequest&)> get;
    std::function<void(BakeRequest&, const Json&)> set;
};

/// All fields, in the order of the documentation.
const std::vector<RequestField>& request_fields();

/// Throws the Error(usage) for a value of the wrong type: `path`, what was found, what is allowed.
[[noreturn]] void refuse_value(const std::string& path, const RequestField::Json& found, const std::string& allowed);

}  // namespace hairbake
