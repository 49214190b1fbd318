#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <string>

#include "core/hair/hair_format.h"
#include "core/hair/hair_reader.h"
#include "core/hair/tfx_reader.h"

namespace hairbake {
namespace {

constexpr std::array<const HairReader*, 2> readers{
    &hair_format_reader,
    &tfx_reader,
};

/// The first four bytes as a person can compare them with a hex dump.
std::string first_bytes_text(const HairSource& source) {
    std::array<unsigned char, 4> bytes{};
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(source.size, bytes.size()));
    source.copy(0, bytes.data(), count);
    std::string text = count == 0 ? "nothing" : "";
    for (std::size_t i = 0; i < count; ++i) {
        char digits[4];
        std::snprintf(digits, sizeof digits, "%s%02x", i > 0 ? " " : "", bytes[i]);
        text += digits;
    }
    return text;
}

}  // namespace

std::span<const HairReader* const> hair_readers() { return readers; }

void refuse_beginning(const HairSource& source) {
    std::string allowed;
    for (const HairReader* reader : readers) allowed += (allowed.empty() ? "" : ", ") + std::string(reader->beginning);
    refuse_hair(source.name,
                "this is no hair model: the first bytes are " + first_bytes_text(source) + "; allowed are " + allowed);
}

}  // namespace hairbake
