// The contents of a groom file.
#pragma once

#include <string>
#include <vector>

#include "core/hair/hair_file_extras.h"
#include "core/hair/hair_model.h"

namespace hairbake {

/// Settings for reading a groom file.
struct HairReadSettings {
    double time = 0;  ///< seconds; which sample of an animation. Formats without animation warn unless it is 0
};

/// A model with its reader's extras, description and warnings.
struct Groom {
    HairModel model;
    HairFileExtras extras;    ///< for the HAIR form of the model; a reader of another format may leave it alone
    std::string description;  ///< the file's own free text, or what the reader left out; may be empty
    std::vector<std::string> warnings;  ///< for the person who gave the file
};

}  // namespace hairbake
