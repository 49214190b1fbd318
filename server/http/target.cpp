#include "server/http/target.h"

#include <algorithm>
#include <charconv>

namespace hairbake {
namespace {

bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

/// "a=1&b" -> {{"a", "1"}, {"b", ""}}.
std::optional<std::map<std::string, std::string>> read_query(const std::string& text) {
    std::map<std::string, std::string> query;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find('&', begin), text.size());
        const std::string part = text.substr(begin, end - begin);
        const std::size_t equals = std::min(part.find('='), part.size());
        const auto name = percent_decoded(part.substr(0, equals));
        const auto value = percent_decoded(equals < part.size() ? part.substr(equals + 1) : "");
        if (!name || !value) return std::nullopt;
        if (!name->empty()) query[*name] = *value;
        begin = end + 1;
    }
    return query;
}

}  // namespace

std::optional<std::string> percent_decoded(const std::string& text) {
    std::string decoded;
    decoded.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
        char c = text[i];
        if (c == '%') {
            const int high = i + 2 < text.size() ? hex_digit(text[i + 1]) : -1;
            const int low = i + 2 < text.size() ? hex_digit(text[i + 2]) : -1;
            if (high < 0 || low < 0) return std::nullopt;
            c = static_cast<char>(high * 16 + low);
            i += 2;
        }
        if (is_control(c)) return std::nullopt;
        decoded += c;
    }
    return decoded;
}

std::optional<Target> read_target(const std::string& text) {
    if (text.empty() || text[0] != '/' || text.find('#') != std::string::npos) return std::nullopt;
    const std::size_t mark = std::min(text.find('?'), text.size());
    Target target;
    for (std::size_t begin = 1; begin < mark;) {
        const std::size_t end = std::min(text.find('/', begin), mark);
        auto segment = percent_decoded(text.substr(begin, end - begin));
        if (!segment || segment->empty() || *segment == "." || *segment == ".." ||
            segment->find('/') != std::string::npos)
            return std::nullopt;
        target.path.push_back(std::move(*segment));
        begin = end + 1;
    }
    auto query = read_query(mark < text.size() ? text.substr(mark + 1) : "");
    if (!query) return std::nullopt;
    target.query = std::move(*query);
    return target;
}

bool has_control_characters(const std::string& value) {
    return std::any_of(value.begin(), value.end(), [](char c) { return is_control(c) && c != '\t'; });
}

std::optional<std::uint64_t> read_length(const std::string& text) {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

}  // namespace hairbake
