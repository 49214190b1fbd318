// The kinds of errors by name, for protocols and stored records.
#pragma once

#include "core/base/error.h"
#include "core/base/names.h"

namespace hairbake {

inline constexpr std::array error_kind_names{
    EnumName{ErrorKind::usage, "usage"}, EnumName{ErrorKind::bad_input, "bad_input"},
    EnumName{ErrorKind::out_of_resources, "out_of_resources"}, EnumName{ErrorKind::cancelled, "cancelled"},
    EnumName{ErrorKind::internal, "internal"}};

constexpr std::string_view name_of(ErrorKind kind) { return name_in(error_kind_names, kind); }

}  // namespace hairbake
