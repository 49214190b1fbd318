// What a groom file gives.
#pragma once

#include <string>
#include <vector>

#include "core/hair/hair_file_extras.h"
#include "core/hair/hair_model.h"

namespace hairbake {

/// How a groom file is read.
struct HairReadSettings {
    double time = 0;  ///< seconds; which sample of an animation. Formats without animation warn unless it is 0
};

/// A model and what its reader tells about it.
struct Groom {
    HairModel model;
    HairFileExtras extras;    ///< for the HAIR form of the model; a reader of another format may leave it alone
    std::string description;  ///< the file's own free text, or what the reader left out; may be empty
    std::vector<std::string> warnings;  ///< for the person who gave the file
};

}  // namespace hairbake
