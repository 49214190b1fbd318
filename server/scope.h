// The scopes of tokens and routes.
#pragma once

#include "core/base/names.h"

namespace hairbake {

/// What a route demands and a token grants. Routes of the scope `open` serve everybody.
enum class Scope { open, read, upload, bake, admin };

/// Those that a token can have.
inline constexpr std::array token_scopes{EnumName{Scope::read, "read"}, EnumName{Scope::upload, "upload"},
                                         EnumName{Scope::bake, "bake"}, EnumName{Scope::admin, "admin"}};

inline std::string name_of(Scope scope) {
    return scope == Scope::open ? "open" : std::string(name_in(token_scopes, scope));
}

}  // namespace hairbake
