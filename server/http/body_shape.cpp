#include "server/http/body_shape.h"

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "core/base/json_reason.h"
#include "core/base/short_text.h"
#include "server/http/body_place.h"
#include "server/http/utf8.h"
#include "server/jobs/service.h"

namespace hairbake {
namespace {

using Json = BodyPlace::Json;
constexpr std::size_t longest_lexeme = 32 << 10, longest_error = 300;
constexpr std::size_t usual_items = 64, usual_length = 4096;  // where the schema has no number

/// A string, number or word of the text.
struct Lexeme {
    std::size_t begin = 0, bytes = 0;
};

/// The first one of the text for which `is_wanted` holds while it is read. Nothing when there is none.
std::optional<Lexeme> find_lexeme(std::string_view json,
                                  const std::function<bool(const Lexeme&, std::size_t at)>& is_wanted) {
    constexpr std::string_view between = "[]{},: \t\r\n\"";
    bool in_string = false;
    Lexeme lexeme;
    for (std::size_t i = 0; i < json.size(); ++i) {
        const char c = json[i];
        if (in_string ? c == '"' : between.find(c) != std::string_view::npos)
            lexeme = {c == '"' && !in_string ? i : i + 1, 0};
        else
            ++lexeme.bytes;
        if (c == '"') in_string = !in_string;
        if (in_string && c == '\\') ++i, ++lexeme.bytes;  // and the character that it escapes
        if (is_wanted(lexeme, i)) return lexeme;
    }
    return std::nullopt;
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
    /// Of a text that is cut after `bytes` bytes, before a value or a name.
    explicit Shape(const Json& schema, std::size_t bytes = std::string::npos) : root_(schema), bytes_(bytes) {}

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
        object.has_value = false;
        return true;
    }

    bool parse_error(std::size_t position, const std::string&, const Json::exception& error) override {
        if (position > bytes_) return false;  // the cut, and no error before it
        next_place().refuse("is not JSON: " + shortened(json_reason(error), longest_error) + " (byte " +
                                std::to_string(position) + " of the body)",
                            Refused::malformed);
    }

    /// The place of the value before which the text was cut. Before a name it is that of the object.
    BodyPlace next_place() const {
        if (levels_.empty()) return BodyPlace(root_);
        BodyPlace next = walk(is_name_next() || levels_.back().is_list ? levels_.size() - 1 : levels_.size());
        if (levels_.back().is_list) next.enter(levels_.back().count);
        return next;
    }
    bool is_name_next() const { return !levels_.empty() && !levels_.back().is_list && levels_.back().has_value; }

private:
    /// An open list or object.
    struct Level {
        const Json* schema;
        bool is_list;
        const Json* inner = nullptr;     ///< of the present item or field
        std::size_t count = 0;           ///< items
        std::vector<std::string> names;  ///< fields; the last is the present one
        bool has_value = true;           ///< the present field, or there is none
    };

    /// Counts the value that begins; returns its schema.
    const Json* begin_value() {
        if (levels_.empty()) return &root_;
        Level& level = levels_.back();
        level.has_value = true;
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
    const std::size_t bytes_;
    std::vector<Level> levels_;
};

/// The place of a string, number or name, and the beginning of a sentence about it.
struct Found {
    BodyPlace place;
    std::string begin;
};

/// Of the one that begins at `at`.
/// Throws Refusal for an error before it.
Found found_at(const std::string& text, std::size_t at, const Json& schema) {
    Shape before(schema, at);
    Json::sax_parse(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), &before);
    return {before.next_place(), before.is_name_next() ? "has a field whose name is " : "is "};
}

void check_encoding(const std::string& text, const Json& schema) {
    const auto wrong = first_not_utf8(text);
    if (!wrong) return;
    const auto lexeme = find_lexeme(text, [&](const Lexeme&, std::size_t at) { return at >= *wrong; });
    const Found found = found_at(text, std::min(lexeme ? lexeme->begin : *wrong, *wrong), schema);
    char byte[8];
    std::snprintf(byte, sizeof byte, "0x%02x", static_cast<unsigned char>(text[*wrong]));
    found.place.refuse(found.begin + "no UTF-8: the byte " + byte + " at byte " + std::to_string(*wrong) +
                           " of the body begins no whole character; allowed is JSON in UTF-8",
                       Refused::malformed);
}

void check_lengths(const std::string& text, const Json& schema) {
    const auto longer = find_lexeme(text, [](const Lexeme& l, std::size_t) { return l.bytes > longest_lexeme; });
    if (!longer) return;
    const Found found = found_at(text, longer->begin, schema);
    found.place.refuse(found.begin + "a text or number of more than " + std::to_string(longest_lexeme) +
                       " bytes; allowed are up to " +
                       std::to_string(bound(found.place.schema(), "maxLength", usual_length)) + " characters");
}

}  // namespace

void check_shape(const std::string& text, const Json& schema) {
    check_encoding(text, schema);
    check_lengths(text, schema);
    Shape shape(schema);
    Json::sax_parse(text, &shape);
}

}  // namespace hairbake
