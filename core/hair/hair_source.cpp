#include "core/hair/hair_source.h"

#include <cmath>

#include "core/base/error.h"

namespace hairbake {
namespace {

constexpr float largest_coordinate = 1e18f;

}  // namespace

void refuse_hair(const std::string& name, const std::string& what) {
    throw Error(ErrorKind::bad_input, name + ": " + what);
}

void check_numbers(const std::string& name, const HairModel& model) {
    const auto at = [&](std::size_t i, const char* what, float found, const char* allowed) {
        refuse_hair(name, place_of_point(model, i) + ": " + what + " is " + std::to_string(found) + "; " + allowed);
    };
    for (std::size_t i = 0; i < model.positions.size(); ++i)
        for (int axis = 0; axis < 3; ++axis)
            if (const float c = model.positions[i][axis]; !(std::abs(c) <= largest_coordinate))
                at(i, axis == 0 ? "x" : axis == 1 ? "y" : "z", c, "allowed are finite numbers up to 1e18 in magnitude");
    for (std::size_t i = 0; i < model.thickness.size(); ++i)
        if (!std::isfinite(model.thickness[i])) at(i, "the thickness", model.thickness[i], "it must be finite");
    for (std::size_t i = 0; i < model.transparency.size(); ++i)
        if (!std::isfinite(model.transparency[i]))
            at(i, "the transparency", model.transparency[i], "it must be finite");
    for (std::size_t i = 0; i < model.colors.size(); ++i)
        for (int channel = 0; channel < 3; ++channel)
            if (const float c = model.colors[i][channel]; !std::isfinite(c))
                at(i, "the colour", c, "it must be finite");

    // A default counts only where its array is missing: writers leave junk in the others.
    const auto check_default = [&](bool used, const char* what, bool finite) {
        if (used && !finite) refuse_hair(name, std::string("header: the default ") + what + " is not a finite number");
    };
    check_default(model.thickness.empty(), "thickness", std::isfinite(model.default_thickness));
    check_default(model.transparency.empty(), "transparency", std::isfinite(model.default_transparency));
    check_default(model.colors.empty(), "colour", is_finite(model.default_color));
}

}  // namespace hairbake
