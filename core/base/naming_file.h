// Adds the name of the file to errors of functions that see only its contents.
#pragma once

#include <string>

#include "core/base/error.h"

namespace hairbake {

/// Runs `body`. Messages of its Error(bad_input) then begin with `file`.
template <class Body>
auto naming_file(const std::string& file, const Body& body) {
    try {
        return body();
    } catch (const Error& error) {
        if (error.kind() != ErrorKind::bad_input) throw;
        throw Error(error.kind(), file + ": " + error.what(), error.field(), error.system_error());
    }
}

}  // namespace hairbake
