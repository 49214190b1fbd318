// Texts of clients and files, made fit for messages.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace hairbake {

/// The text with its control characters as JSON escapes them (\u0000): they would cut or garble a message.
/// `kept` are control characters that stay.
inline std::string escaped(const std::string& text, std::string_view kept = {}) {
    const auto is_control = [&](char c) {
        return (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) && kept.find(c) == std::string_view::npos;
    };
    constexpr char digits[] = "0123456789abcdef";
    std::string shown;
    shown.reserve(text.size());
    for (const char c : text)
        if (is_control(c))
            shown += {'\\', 'u', '0', '0', digits[c >> 4 & 15], digits[c & 15]};
        else
            shown += c;
    return shown;
}

/// At most the first `length` bytes of a UTF-8 text, with "..." after them where the text is longer. No character is
/// cut.
inline std::string shortened(const std::string& text, std::size_t length) {
    if (text.size() <= length) return text;
    while (length > 0 && (static_cast<unsigned char>(text[length]) & 0xc0) == 0x80) --length;
    return text.substr(0, length) + "...";
}

/// The text with control characters escaped, in quotation marks, cut after `length` bytes.
inline std::string quoted(const std::string& text, std::size_t length) {
    return '"' + shortened(escaped(text), length) + '"';
}

/// Puts `to` for every `from`, which is not empty.
inline void replace_all(std::string& text, std::string_view from, std::string_view to) {
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
        text.replace(at, from.size(), to);
}

}  // namespace hairbake
