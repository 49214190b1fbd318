// Makers of the request's fields: a number, a choice, a list. Private to core/request.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/request/request_fields.h"

namespace hairbake::field_kinds {

using Json = RequestField::Json;
using Field = RequestField;

// ---- values ------------------------------------------------------------------------------------------------------

inline double read_number(const std::string& path, const Json& value, const std::string& allowed = "a number") {
    if (!value.is_number() || !std::isfinite(value.get<double>())) refuse_value(path, value, allowed);
    return value.get<double>();
}

/// 100 and 100.0 are both the integer 100, as in JSON Schema.
template <class Integer>
Integer read_integer(const std::string& path, const Json& value, const std::string& allowed = "an integer") {
    const double number = read_number(path, value, allowed);
    const double high = std::min(0x1p53, static_cast<double>(std::numeric_limits<Integer>::max()));
    const double low = std::max(-0x1p53, static_cast<double>(std::numeric_limits<Integer>::lowest()));
    if (number != std::floor(number) || !(number >= low && number <= high)) refuse_value(path, value, allowed);
    return static_cast<Integer>(number);
}

inline std::string read_string(const std::string& path, const Json& value, const std::string& allowed = "a string") {
    if (!value.is_string()) refuse_value(path, value, allowed);
    return value.get<std::string>();
}

// ---- kinds of fields; `at` gives a reference to the member of a (const) request -----------------------------------

template <class At>
Field number(std::string path, At at) {
    return {path, [at](const BakeRequest& r) { return Json(at(r)); },
            [=](BakeRequest& r, const Json& v) { at(r) = read_number(path, v); }};
}

template <class At>
Field optional_number(std::string path, At at) {
    return {path, [at](const BakeRequest& r) { return at(r) ? Json(*at(r)) : Json(); },
            [=](BakeRequest& r, const Json& v) {
                at(r).reset();
                if (!v.is_null()) at(r) = read_number(path, v, "a number or null");
            }};
}

template <class At>
Field integer(std::string path, At at) {
    return {path, [at](const BakeRequest& r) { return Json(at(r)); },
            [=](BakeRequest& r, const Json& v) {
                using Integer = std::remove_reference_t<decltype(at(r))>;
                at(r) = read_integer<Integer>(path, v);
            }};
}

template <class At>
Field integer_or_auto(std::string path, At at) {
    return {path, [at](const BakeRequest& r) { return at(r) ? Json(*at(r)) : Json("auto"); },
            [=](BakeRequest& r, const Json& v) {
                at(r).reset();
                if (v != "auto") at(r) = read_integer<int>(path, v, "an integer or \"auto\"");
            }};
}

template <class At>
Field boolean(std::string path, At at) {
    return {path, [at](const BakeRequest& r) { return Json(at(r)); },
            [=](BakeRequest& r, const Json& v) {
                if (!v.is_boolean()) refuse_value(path, v, "true or false");
                at(r) = v.template get<bool>();
            }};
}

template <class At>
Field optional_string(std::string path, At at) {
    return {path, [at](const BakeRequest& r) { return at(r) ? Json(*at(r)) : Json(); },
            [=](BakeRequest& r, const Json& v) {
                at(r).reset();
                if (!v.is_null()) at(r) = read_string(path, v, "a string or null");
            }};
}

template <class At>
Field triple(std::string path, At at) {
    return {path, [at](const BakeRequest& r) { return Json(at(r)); },
            [=](BakeRequest& r, const Json& v) {
                if (!v.is_array() || v.size() != 3) refuse_value(path, v, "a list of three numbers");
                for (std::size_t i = 0; i < 3; ++i) at(r)[i] = read_number(path, v[i]);
            }};
}

template <class At>
Field string_list(std::string path, At at) {
    return {path, [at](const BakeRequest& r) { return Json(at(r)); },
            [=](BakeRequest& r, const Json& v) {
                if (!v.is_array()) refuse_value(path, v, "a list of strings");
                std::vector<std::string> items;
                for (const Json& item : v) items.push_back(read_string(path, item));
                at(r) = std::move(items);
            }};
}

template <class Enum>
using Names = std::vector<std::pair<std::string, Enum>>;

template <class Enum, class At>
Field choice(std::string path, Names<Enum> names, At at) {
    return {path,
            [=](const BakeRequest& r) {
                for (const auto& [name, value] : names)
                    if (value == at(r)) return Json(name);
                throw Error(ErrorKind::internal, path + " holds a value without a name", path);
            },
            [=](BakeRequest& r, const Json& v) {
                std::string allowed;
                for (const auto& [name, value] : names) {
                    if (v == name) {
                        at(r) = value;
                        return;
                    }
                    allowed += (allowed.empty() ? "one of " : ", ") + name;
                }
                refuse_value(path, v, allowed);
            }};
}

/// A choice by the enum's own table of names.
template <class Enum, std::size_t count, class At>
Field choice(std::string path, const std::array<EnumName<Enum>, count>& table, At at) {
    Names<Enum> names;
    for (const EnumName<Enum>& entry : table) names.emplace_back(entry.name, entry.value);
    return choice<Enum>(std::move(path), std::move(names), at);
}

/// A field that stood at `first_path` in the first version.
inline Field moved(Field field, std::string first_path) {
    field.first_path = std::move(first_path);
    return field;
}

/// A field that the first version did not have. Its behaviour was that of `first_value`.
inline Field added(Field field, Json first_value) {
    field.first_value = std::move(first_value);
    return field;
}

}  // namespace hairbake::field_kinds
