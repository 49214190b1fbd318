// The file's name for errors of checks that see its numbers only.
#pragma once

#include <string>

#include "core/base/error.h"

namespace hairbake {

/// Runs `body`; what it says of bad input then begins with `file`.
template <class Body>
auto naming_file(const std::string& file, const Body& body) {
    try {
        return body();
    } catch (const Error& error) {
        if (error.kind() != ErrorKind::bad_input) throw;
        throw Error(error.kind(), file + ": " + error.what(), error.field());
    }
}

}  // namespace hairbake
