#include "core/environment/color_primaries.h"

#include <cmath>
#include <sstream>

#include "core/base/assert.h"
#include "core/environment/environment_map.h"

namespace hairbake {
namespace {

struct Known {
    ToPrimaries target;
    const char* name;
    Chromaticities xy;
};
constexpr Known known[] = {
    {ToPrimaries::rec709, "Rec.709", {.64f, .33f, .30f, .60f, .15f, .06f, .3127f, .3290f}},
    {ToPrimaries::rec2020, "Rec.2020", {.708f, .292f, .170f, .797f, .131f, .046f, .3127f, .3290f}},
    {ToPrimaries::display_p3, "Display P3", {.68f, .32f, .265f, .69f, .15f, .06f, .3127f, .3290f}},
    {ToPrimaries::aces, "ACES AP0", {.7347f, .2653f, 0.f, 1.f, .0001f, -.077f, .32168f, .33767f}},
    {ToPrimaries::acescg, "ACEScg AP1", {.713f, .293f, .165f, .83f, .128f, .044f, .32168f, .33767f}},
};

constexpr Matrix3 bradford{Vec3d{0.8951, 0.2664, -0.1614}, Vec3d{-0.7502, 1.7135, 0.0367},
                           Vec3d{0.0389, -0.0685, 1.0296}};

Matrix3 transpose(const Matrix3& m) {
    return {Vec3d{m[0].x, m[1].x, m[2].x}, Vec3d{m[0].y, m[1].y, m[2].y}, Vec3d{m[0].z, m[1].z, m[2].z}};
}

Matrix3 operator*(const Matrix3& a, const Matrix3& b) {
    return {transform_back(b, a[0]), transform_back(b, a[1]), transform_back(b, a[2])};
}

double determinant(const Matrix3& m) { return dot(m[0], cross(m[1], m[2])); }

Matrix3 inverse(const Matrix3& m) {
    const double d = determinant(m);
    return transpose({cross(m[1], m[2]) / d, cross(m[2], m[0]) / d, cross(m[0], m[1]) / d});
}

Matrix3 scaling(const Vec3d& s) { return {Vec3d{s.x, 0, 0}, Vec3d{0, s.y, 0}, Vec3d{0, 0, s.z}}; }

/// XYZ with Y = y, so that primaries on the line y = 0 (ACES AP0 has one below it) stay finite.
Vec3d xyz(const Chromaticities& c, int i) {
    const double x = c[2 * i], y = c[2 * i + 1];
    return {x, y, 1 - x - y};
}

Vec3d white_of(const Chromaticities& c) { return xyz(c, 3) / double(c[7]); }

Matrix3 primaries_of(const Chromaticities& c) { return transpose({xyz(c, 0), xyz(c, 1), xyz(c, 2)}); }

/// RGB to XYZ, white (1, 1, 1) at Y = 1 (SMPTE RP 177).
Matrix3 to_xyz(const Chromaticities& c) {
    const Matrix3 primaries = primaries_of(c);
    return primaries * scaling(transform(inverse(primaries), white_of(c)));
}

Matrix3 adaptation(const Chromaticities& from, const Chromaticities& to) {
    const Vec3d a = transform(bradford, white_of(from)), b = transform(bradford, white_of(to));
    return inverse(bradford) * scaling({b.x / a.x, b.y / a.y, b.z / a.z}) * bradford;
}

std::string listed(const Chromaticities& xy) {
    std::ostringstream text;
    text << "red " << xy[0] << ' ' << xy[1] << ", green " << xy[2] << ' ' << xy[3] << ", blue " << xy[4] << ' ' << xy[5]
         << ", white " << xy[6] << ' ' << xy[7];
    return text.str();
}

}  // namespace

std::string name_of(const Chromaticities& primaries) {
    for (const Known& k : known) {
        bool same = true;
        for (std::size_t i = 0; i < primaries.size(); ++i) same &= std::abs(k.xy[i] - primaries[i]) < 2e-3f;
        if (same) return k.name;
    }
    return "custom: " + listed(primaries);
}

std::optional<Chromaticities> chromaticities_of(ToPrimaries target) {
    for (const Known& k : known)
        if (k.target == target) return k.xy;
    return std::nullopt;
}

Chromaticities default_chromaticities() { return known[0].xy; }

std::string fault_of(const Chromaticities& primaries) {
    bool ok = true;
    for (const float value : primaries) ok &= std::isfinite(value) && std::abs(value) <= 10;
    if (ok) {
        // White must be a mixture of the three with positive shares.
        const Matrix3 m = primaries_of(primaries);
        ok = std::abs(determinant(m)) > 1e-6 && primaries[7] > 1e-6f;
        if (ok) {
            const Vec3d shares = transform(inverse(m), white_of(primaries));
            const Vec3d cone = transform(bradford, white_of(primaries));
            ok = shares.x > 0 && shares.y > 0 && shares.z > 0 && cone.x > 0 && cone.y > 0 && cone.z > 0;
        }
    }
    return ok ? std::string() : listed(primaries) + ": white is no mixture of these primaries";
}

Matrix3 rgb_conversion(const Chromaticities& from, const Chromaticities& to) {
    HAIRBAKE_ASSERT(fault_of(from).empty() && fault_of(to).empty());
    return inverse(to_xyz(to)) * adaptation(from, to) * to_xyz(from);
}

Vec3d luminance_weights(const Chromaticities& primaries) {
    HAIRBAKE_ASSERT(fault_of(primaries).empty());
    return to_xyz(primaries)[1];
}

Matrix3 rgb_from_xyz(const Chromaticities& primaries) {
    HAIRBAKE_ASSERT(fault_of(primaries).empty());
    return inverse(to_xyz(primaries));
}

}  // namespace hairbake
