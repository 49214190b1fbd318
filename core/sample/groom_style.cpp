#include "core/sample/groom_style.h"

#include <string>

#include "core/base/error.h"

namespace hairbake {

std::string_view name_of(GroomStyle style) {
    for (const NamedGroomStyle& named : groom_styles)
        if (named.style == style) return named.name;
    throw Error(ErrorKind::internal, "a groom style has no name");
}

GroomStyle groom_style_named(std::string_view name) {
    std::string allowed;
    for (const NamedGroomStyle& named : groom_styles) {
        if (named.name == name) return named.style;
        allowed += (allowed.empty() ? "" : ", ") + std::string(named.name);
    }
    throw Error(ErrorKind::usage, "style is \"" + std::string(name) + "\"; allowed is one of " + allowed, "style");
}

}  // namespace hairbake
