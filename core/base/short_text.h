// Texts of clients and files, cut for messages.
#pragma once

#include <cstddef>
#include <string>

namespace hairbake {

/// At most the first `length` bytes of a UTF-8 text, with "..." after them where the text is longer. No character is
/// cut.
inline std::string shortened(const std::string& text, std::size_t length) {
    if (text.size() <= length) return text;
    while (length > 0 && (static_cast<unsigned char>(text[length]) & 0xc0) == 0x80) --length;
    return text.substr(0, length) + "...";
}

}  // namespace hairbake
