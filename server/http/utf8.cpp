#include "server/http/utf8.h"

namespace hairbake {
namespace {

/// What may follow the first byte of a character: so many bytes in all, and the range of the second. 0: no character
/// begins so. All further bytes are in 0x80 to 0xbf.
struct Sequence {
    std::size_t bytes = 0;
    unsigned char low = 0x80, high = 0xbf;
};

Sequence sequence_of(unsigned char first) {
    if (first < 0x80) return {1};
    if (first >= 0xc2 && first <= 0xdf) return {2};
    if (first == 0xe0) return {3, 0xa0, 0xbf};
    if (first == 0xed) return {3, 0x80, 0x9f};
    if (first >= 0xe1 && first <= 0xef) return {3};
    if (first == 0xf0) return {4, 0x90, 0xbf};
    if (first == 0xf4) return {4, 0x80, 0x8f};
    if (first >= 0xf1 && first <= 0xf3) return {4};
    return {};
}

}  // namespace

std::optional<std::size_t> first_not_utf8(std::string_view text) {
    for (std::size_t at = 0; at < text.size();) {
        const Sequence sequence = sequence_of(static_cast<unsigned char>(text[at]));
        if (sequence.bytes == 0 || sequence.bytes > text.size() - at) return at;
        for (std::size_t i = 1; i < sequence.bytes; ++i) {
            const auto byte = static_cast<unsigned char>(text[at + i]);
            if (byte < (i == 1 ? sequence.low : 0x80) || byte > (i == 1 ? sequence.high : 0xbf)) return at;
        }
        at += sequence.bytes;
    }
    return std::nullopt;
}

}  // namespace hairbake
