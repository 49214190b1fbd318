// The request's fibre block, and models, of one exponent.
#pragma once

#include "core/fiber/fiber_model.h"

namespace hairbake::testing {

inline FiberSettings kajiya_kay(double exponent) {
    FiberSettings settings;
    settings.model = FiberModelKind::kajiya_kay;
    settings.kajiya_kay.exponent = exponent;
    return settings;
}

inline std::unique_ptr<const FiberModel> kajiya_kay_model(double exponent) {
    return make_fiber_model(kajiya_kay(exponent));
}

}  // namespace hairbake::testing
