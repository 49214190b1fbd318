// Whether bytes are UTF-8.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace hairbake {

/// Where the first sequence begins that is no character in UTF-8 (Unicode 15, table 3-7), also if it is one that the
/// end of the text or a quotation mark cuts. Nothing when there is none.
std::optional<std::size_t> first_not_utf8(std::string_view text);

}  // namespace hairbake
