// Colour spaces of linear RGB: the chromaticities of their primaries and white point, and conversion between them.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "core/base/vec.h"
#include "core/environment/environment_settings.h"

namespace hairbake {

/// CIE 1931 x and y of red, green, blue and white, in this order.
using Chromaticities = std::array<float, 8>;

/// Primaries of a picture's colours.
struct NamedPrimaries {
    std::string name = "unspecified";  ///< "Rec.709", ..., "custom: ..."
    std::optional<Chromaticities> xy;  ///< empty when unspecified
};

/// The name of known primaries ("Rec.709", "ACEScg AP1", ...), which match within 0.002 in each coordinate; else
/// "custom: red 0.7 0.3, green ...".
std::string name_of(const Chromaticities& primaries);

/// Null for ToPrimaries::file.
std::optional<Chromaticities> chromaticities_of(ToPrimaries target);

/// What a file means that names no primaries: those of Rec.709, as OpenEXR's documentation says.
Chromaticities default_chromaticities();

/// Empty where RGB of these primaries has a meaning; else the fault: "red 0 0, green ...: white is no mixture of these
/// primaries".
std::string fault_of(const Chromaticities& primaries);

/// The matrix (rows) from linear RGB of `from` to linear RGB of `to`: over CIE XYZ, with the Bradford adaptation
/// between two white points (Lam 1985; ICC.1:2010, annex E). White (1, 1, 1) becomes white. Colours outside `to` get
/// negative values. Both must have no fault. Thread-safe.
std::array<Vec3d, 3> rgb_conversion(const Chromaticities& from, const Chromaticities& to);

/// The share of red, green and blue in the luminance Y of colours of these primaries; the three add up to 1. The
/// primaries must have no fault.
Vec3d luminance_weights(const Chromaticities& primaries);

/// The matrix (rows) from CIE XYZ to linear RGB of these primaries, whose white (1, 1, 1) has Y = 1. No adaptation of the
/// white. The primaries must have no fault.
std::array<Vec3d, 3> rgb_from_xyz(const Chromaticities& primaries);

/// Primaries of Radiance pictures that name none (src/common/color.h of Radiance).
inline constexpr Chromaticities radiance_chromaticities{.640f, .330f, .290f, .600f, .150f, .060f, 1 / 3.f, 1 / 3.f};

}  // namespace hairbake
