#include "core/mesh/ply_header.h"

#include <array>
#include <charconv>
#include <system_error>
#include <utility>

#include "core/mesh/mesh_reader.h"

namespace hairbake {
namespace {

constexpr std::size_t most_elements = 64, most_properties = 256;

struct TypeName {
    std::string_view name;
    PlyType type;
};
constexpr std::array type_names{
    TypeName{"char", PlyType::int8},      TypeName{"int8", PlyType::int8},       TypeName{"uchar", PlyType::uint8},
    TypeName{"uint8", PlyType::uint8},    TypeName{"short", PlyType::int16},     TypeName{"int16", PlyType::int16},
    TypeName{"ushort", PlyType::uint16},  TypeName{"uint16", PlyType::uint16},   TypeName{"int", PlyType::int32},
    TypeName{"int32", PlyType::int32},    TypeName{"uint", PlyType::uint32},     TypeName{"uint32", PlyType::uint32},
    TypeName{"float", PlyType::float32},  TypeName{"float32", PlyType::float32}, TypeName{"double", PlyType::float64},
    TypeName{"float64", PlyType::float64}};

/// The words of a line.
class LineWords {
public:
    explicit LineWords(std::string_view line) : rest_(line) {}
    std::string_view next() {
        const std::size_t begin = rest_.find_first_not_of(" \t");
        if (begin == std::string_view::npos) return {};
        rest_.remove_prefix(begin);
        const std::string_view word = rest_.substr(0, rest_.find_first_of(" \t"));
        rest_.remove_prefix(word.size());
        return word;
    }

private:
    std::string_view rest_;
};

class HeaderParser {
public:
    HeaderParser(std::string_view text, const std::string& name) : text_(text), name_(name) {}

    PlyHeader parse() {
        find_line_end();
        if (next_line() != "ply") refuse("the file does not begin with a line \"ply\"");
        bool has_format = false;
        for (;;) {
            const std::string_view line = next_line();
            LineWords words(line);
            const std::string_view key = words.next();
            if (key == "end_header") break;
            if (key == "format") {
                read_format(words);
                has_format = true;
            } else if (key == "element") {
                read_element(words);
            } else if (key == "property") {
                read_property(words);
            } else if (!key.empty() && key != "comment" && key != "obj_info") {
                refuse(quoted_word(key) +
                       " begins no line of a header; allowed are format, element, property, comment, end_header");
            }
        }
        if (!has_format) refuse("the header has no line \"format\"");
        header_.bytes = at_;
        return std::move(header_);
    }

private:
    [[noreturn]] void refuse(const std::string& what) const {
        refuse_mesh(name_ + ", line " + std::to_string(header_.lines), what);
    }

    void find_line_end() {
        const std::size_t first = text_.find_first_of("\r\n");
        if (first == std::string_view::npos) return;
        line_end_ = text_.substr(first).starts_with("\r\n") ? "\r\n" : text_.substr(first, 1);
    }
    std::string_view next_line() {
        const std::size_t end = text_.find(line_end_, at_);
        ++header_.lines;
        if (end == std::string_view::npos) refuse("the header has no end (end_header)");
        const std::string_view line = text_.substr(at_, end - at_);
        at_ = end + line_end_.size();
        return line;
    }

    void read_format(LineWords& words) {
        const std::string_view format = words.next(), version = words.next();
        if (format == "ascii")
            header_.format = PlyFormat::ascii;
        else if (format == "binary_little_endian")
            header_.format = PlyFormat::little_endian;
        else if (format == "binary_big_endian")
            header_.format = PlyFormat::big_endian;
        else
            refuse("the format is " + quoted_word(format) +
                   "; allowed are ascii, binary_little_endian and binary_big_endian");
        if (version != "1.0") refuse("the version is " + quoted_word(version) + "; allowed is 1.0");
    }
    void read_element(LineWords& words) {
        PlyElement element;
        element.name = words.next();
        const std::string_view count = words.next();
        const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), element.count);
        if (element.name.empty() || count.empty() || error != std::errc() || end != count.data() + count.size())
            refuse("an element has a name and a number; found are " + quoted_word(element.name) + " and " +
                   quoted_word(count));
        if (header_.elements.size() == most_elements) refuse("more elements than " + std::to_string(most_elements));
        header_.elements.push_back(std::move(element));
    }
    PlyType read_type(LineWords& words) const {
        const std::string_view word = words.next();
        for (const TypeName& type : type_names)
            if (type.name == word) return type.type;
        refuse(quoted_word(word) +
               " is no type of a property; allowed are char, uchar, short, ushort, int, uint, "
               "float and double, or int8 to float64");
    }
    void read_property(LineWords& words) {
        if (header_.elements.empty()) refuse("a property stands before the first element");
        std::vector<PlyProperty>& properties = header_.elements.back().properties;
        if (properties.size() == most_properties)
            refuse("more properties of an element than " + std::to_string(most_properties));
        LineWords list = words;
        PlyProperty property;
        if (list.next() == "list") {
            words = list;
            property.count_type = read_type(words);
            if (*property.count_type == PlyType::float32 || *property.count_type == PlyType::float64)
                refuse("the number of items of a list is a float; allowed are integers");
        }
        property.type = read_type(words);
        property.name = words.next();
        properties.push_back(std::move(property));
    }

    std::string_view text_, line_end_ = "\n";
    const std::string& name_;
    std::size_t at_ = 0;
    PlyHeader header_;
};

}  // namespace

std::size_t size_of(PlyType type) {
    switch (type) {
        case PlyType::int8:
        case PlyType::uint8:
            return 1;
        case PlyType::int16:
        case PlyType::uint16:
            return 2;
        case PlyType::int32:
        case PlyType::uint32:
        case PlyType::float32:
            return 4;
        case PlyType::float64:
            break;
    }
    return 8;
}

PlyHeader read_ply_header(std::string_view text, const std::string& name) { return HeaderParser(text, name).parse(); }

}  // namespace hairbake
