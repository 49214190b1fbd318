#include "server/http/body_shape.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "core/base/json_nesting.h"
#include "server/http/body_place.h"
#include "server/jobs/service.h"

namespace hairbake {
namespace {

using Json = BodyPlace::Json;
constexpr int deepest = 16;  // levels of a request; later parsers recurse no deeper
constexpr std::size_t longest_lexeme = 32 << 10, longest_error = 300;
constexpr std::size_t usual_items = 64, usual_length = 4096;  // where the schema has no number

/// Whether a string or number is longer than `most` bytes. The parser would copy it several times.
bool has_longer_lexeme(std::string_view json, std::size_t most) {
    constexpr std::string_view between = "[]{},: \t\r\n\"";
    bool in_string = false;
    for (std::size_t i = 0, length = 0; i < json.size(); ++i) {
        const char c = json[i];
        length = (in_string ? c == '"' : between.find(c) != std::string_view::npos) ? 0 : length + 1;
        if (c == '"') in_string = !in_string;
        if (in_string && c == '\\') ++i, ++length;  // and the character that it escapes
        if (length > most) return true;
    }
    return false;
}

/// A number of the schema, such as maxItems.
std::size_t bound(const Json* schema, const char* name, std::size_t otherwise) {
    return schema ? schema->value(name, otherwise) : otherwise;
}

/// Whether the schema's `type` is `type` or a list that has it.
bool names_type(const Json& schema, std::string_view type) {
    const auto found = schema.find("type");
    if (found == schema.end()) return false;
    return found->is_array() ? std::find(found->begin(), found->end(), type) != found->end() : *found == type;
}

/// The schema, or the one of its alternatives, that names the type. Null when there is none.
const Json* with_type(const Json* schema, std::string_view type) {
    if (!schema || names_type(*schema, type)) return schema;
    const auto alternatives = schema->find("anyOf");
    if (alternatives == schema->end()) return nullptr;
    const auto found = std::find_if(alternatives->begin(), alternatives->end(),
                                    [&](const Json& one) { return names_type(one, type); });
    return found == alternatives->end() ? nullptr : &*found;
}

/// Receives the parser's events.
class Shape : public nlohmann::json_sax<Json> {
public:
    explicit Shape(const Json& schema) : root_(schema) {}

    bool null() override { return scalar({"null"}, Json()); }
    bool boolean(bool value) override { return scalar({"boolean"}, value); }
    bool number_integer(std::int64_t value) override { return scalar({"integer", "number"}, value); }
    bool number_unsigned(std::uint64_t value) override { return scalar({"integer", "number"}, value); }
    bool number_float(double value, const std::string&) override { return scalar({"integer", "number"}, value); }
    bool binary(Json::binary_t&) override { return true; }  // not in JSON

    bool string(std::string& value) override {
        const Json* schema = begin_value();
        if (schema && schema->contains("type") && !names_type(*schema, "string")) place().refuse_value(shown(value));
        const std::size_t most = bound(schema, "maxLength", usual_length);  // characters; a character has 1 to 4 bytes
        if (value.size() > 4 * most)
            place().refuse("is a text of " + std::to_string(value.size()) + " bytes; allowed are up to " +
                           std::to_string(most) + " characters");
        return true;
    }
    bool start_object(std::size_t) override { return start("object", "{...}"); }
    bool start_array(std::size_t) override { return start("array", "[...]"); }
    bool end_object() override { return end(); }
    bool end_array() override { return end(); }

    bool key(std::string& name) override {
        Level& object = levels_.back();
        object.inner = schema_of_field(object.schema, name);
        if (!object.inner && is_closed(object.schema)) place_of_level().refuse_unknown(name);
        if (std::find(object.names.begin(), object.names.end(), name) != object.names.end()) {
            object.names.push_back(name);
            place().refuse("is given twice; allowed is once");
        }
        if (object.names.size() == usual_items)
            place_of_level().refuse("has more than " + std::to_string(usual_items) + " fields");
        object.names.push_back(name);
        return true;
    }

    bool parse_error(std::size_t, const std::string&, const Json::exception& error) override {
        throw Refusal(Refused::malformed, "the body is not JSON: " + shortened(error.what(), longest_error));
    }

private:
    /// An open list or object.
    struct Level {
        const Json* schema;
        bool is_list;
        const Json* inner = nullptr;     ///< of the present item or field
        std::size_t count = 0;           ///< items
        std::vector<std::string> names;  ///< fields; the last is the present one
    };

    /// Counts the value that begins; returns its schema.
    const Json* begin_value() {
        if (levels_.empty()) return &root_;
        Level& level = levels_.back();
        if (!level.is_list) return level.inner;
        if (level.count == bound(level.schema, "maxItems", usual_items))
            place_of_level().refuse("is a list of more than " + std::to_string(level.count) +
                                    " items; allowed are up to " + std::to_string(level.count));
        ++level.count;
        return level.inner;
    }

    bool scalar(std::initializer_list<const char*> types, const Json& value) {
        const Json* schema = begin_value();
        const auto allowed = [&](const char* type) { return names_type(*schema, type); };
        if (schema && schema->contains("type") && std::none_of(types.begin(), types.end(), allowed))
            place().refuse_value(value.dump());
        return true;
    }

    bool start(const char* type, const char* found) {
        const Json* schema = with_type(begin_value(), type);
        if (!schema) place().refuse_value(found);
        const bool is_list = type == std::string_view("array");
        levels_.push_back({schema, is_list, is_list ? schema_of_items(schema) : nullptr, 0, {}});
        return true;
    }

    bool end() {
        levels_.pop_back();
        return true;
    }

    static std::string shown(const std::string& value) {
        return Json(shortened(value, 100)).dump(-1, ' ', false, Json::error_handler_t::replace);
    }

    /// The place of the innermost open list or object.
    BodyPlace place_of_level() const { return walk(levels_.size() - 1); }
    /// The place of the present value.
    BodyPlace place() const { return walk(levels_.size()); }

    BodyPlace walk(std::size_t steps) const {
        BodyPlace place(root_);
        for (std::size_t i = 0; i < steps; ++i)
            if (levels_[i].is_list)
                place.enter(levels_[i].count - 1);
            else
                place.enter(levels_[i].names.back());
        return place;
    }

    const Json& root_;
    std::vector<Level> levels_;
};

}  // namespace

void check_shape(const std::string& text, const Json& schema) {
    if (nested_deeper_than(text, deepest)) throw Refusal(Refused::malformed, "the body is nested too deeply");
    if (has_longer_lexeme(text, longest_lexeme))
        throw Refusal(Refused::malformed,
                      "the body has a text or number of more than " + std::to_string(longest_lexeme) + " bytes");
    Shape shape(schema);
    Json::sax_parse(text, &shape);
}

}  // namespace hairbake
