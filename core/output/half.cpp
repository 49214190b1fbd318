#include "core/output/half.h"

#include <Imath/half.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/error.h"

namespace hairbake {
namespace {

double largest_of(const CubeTexels& texels, int face_size, const std::string& map) {
    double largest = 0;
    for (std::size_t i = 0; i < texels.size(); ++i) {
        const Vec3f& t = texels[i];
        if (!is_finite(t)) {
            const std::size_t n = static_cast<std::size_t>(face_size);
            throw Error(ErrorKind::bad_input, map + " map: face " + std::string(cube_face_name(int(i / n / n))) +
                                                  ", row " + std::to_string(i / n % n) + ", column " +
                                                  std::to_string(i % n) +
                                                  " is not finite; allowed for half floats are finite maps");
        }
        largest = std::max({largest, std::abs(double(t.x)), std::abs(double(t.y)), std::abs(double(t.z))});
    }
    return largest;
}

}  // namespace

Half to_half(float value) { return Imath::half(value).bits(); }

double half_scale(double largest) {
    if (!std::isfinite(largest))
        throw Error(ErrorKind::bad_input, "a value is not finite; allowed for half floats are finite ones");
    if (largest == 0 || (largest >= 0.0625 && largest <= largest_half)) return 1;
    // largest = f 2^e with f in [0.5, 1): 2^(e-16) takes it to f 65536, which may lie above 65,504.
    int e = 0;
    const double f = std::frexp(largest, &e);
    const int exponent = f * 65536 <= double(largest_half) ? e - 16 : e - 15;
    return std::ldexp(1.0, std::max(exponent, -126));
}

double half_scale(const MapSet& maps) {
    double largest = 0;
    for (const MapLobe& lobe : maps.lobes)
        for (std::size_t i = 0; i < lobe.cubes.size(); ++i)
            largest = std::max(largest, largest_of(lobe.cubes[i], maps.face_size, lobe.label(i)));
    return half_scale(largest);
}

std::vector<Half4> to_half_texels(const CubeTexels& texels, double scale) {
    const double factor = 1 / scale;  // a power of two too
    const auto convert = [factor](float value) { return to_half(static_cast<float>(value * factor)); };
    std::vector<Half4> halves(texels.size());
    const Half one = to_half(1);
    std::transform(texels.begin(), texels.end(), halves.begin(), [&](const Vec3f& t) {
        return Half4{convert(t.x), convert(t.y), convert(t.z), one};
    });
    return halves;
}

}  // namespace hairbake
