// The styles of sample grooms and their names.
#pragma once

#include <array>
#include <string_view>

namespace hairbake {

enum class GroomStyle { straight, wavy, curly };

struct NamedGroomStyle {
    GroomStyle style;
    std::string_view name;
};

/// Every style with the name that the command line takes.
inline constexpr std::array<NamedGroomStyle, 3> groom_styles{
    {{GroomStyle::straight, "straight"}, {GroomStyle::wavy, "wavy"}, {GroomStyle::curly, "curly"}}};

std::string_view name_of(GroomStyle style);

/// Throws Error(usage) with the field "style" for any other name.
GroomStyle groom_style_named(std::string_view name);

}  // namespace hairbake
