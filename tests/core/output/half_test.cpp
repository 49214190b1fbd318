#include "core/output/half.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <fstream>

#include "core/base/error.h"
#include "core/base/random.h"
#include "tests/support/run_program.h"
#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

TEST(Half, RoundsEveryFloatAsNumpyDoes) {
    // Random bit patterns reach every exponent, subnormals, infinity and NaN; then all halfway points between halves.
    const test_support::TemporaryFolder folder;
    std::ofstream stream(folder / "pairs", std::ios::binary);
    const auto add = [&](float value) {
        const Half half = to_half(value);
        stream.write(reinterpret_cast<const char*>(&value), 4);
        stream.write(reinterpret_cast<const char*>(&half), 2);
    };
    Random random(1);
    for (int i = 0; i < 200'000; ++i) add(std::bit_cast<float>(static_cast<std::uint32_t>(random.next_u64() >> 32)));
    for (int exponent = -25; exponent <= 15; ++exponent)
        for (int i = 2048; i < 4096; ++i) add(std::ldexp(static_cast<float>(i) / 2048, exponent));
    stream.close();
    const auto python = test_support::run_python(R"(
import numpy as np, sys
pairs = np.fromfile(sys.argv[1], [('value', '<f4'), ('half', '<f2')])
with np.errstate(all='ignore'): expected = pairs['value'].astype(np.float16)
number = ~np.isnan(expected)
assert np.array_equal(pairs['half'].view('<u2')[number], expected.view('<u2')[number])
assert np.isnan(pairs['half'][~number]).all() and (~number).sum() > 100
print('same'))",
                                                 (folder / "pairs").string());
    EXPECT_EQ(python.output, "same\n");
}

TEST(HalfScale, IsOneWhereHalvesDoAndAPowerOfTwoThatFillsThemElsewhere) {
    for (const double largest : {0.0, 0.0625, 1.0, 65504.0}) EXPECT_EQ(half_scale(largest), 1) << largest;
    EXPECT_EQ(half_scale(std::nextafter(65504.0, 1e9)), 2);
    EXPECT_EQ(half_scale(65536), 2);
    EXPECT_EQ(half_scale(2 * 65504.0), 2);
    EXPECT_EQ(half_scale(131009), 4);
    EXPECT_EQ(half_scale(3.4e38), std::ldexp(1.0, 112));  // 3.4e38 / 65504 = 5.19e33, 2^112 = 5.19e33
    EXPECT_EQ(half_scale(1e-45), std::ldexp(1.0, -126));
    Random random(2);
    for (int i = 0; i < 100'000; ++i) {
        const double largest = std::exp2(random.next(-100, 128));
        const double scale = half_scale(largest), stored = largest / scale;
        int exponent = 0;
        EXPECT_EQ(std::frexp(scale, &exponent), 0.5) << largest;
        EXPECT_LE(stored, 65504) << largest;
        EXPECT_TRUE(stored > 32752 || (scale == 1 && largest >= 0.0625)) << largest;
    }
}

TEST(HalfScale, RefusesWhatIsNotFinite) {
    EXPECT_THROW(half_scale(INFINITY), Error);
    EXPECT_THROW(half_scale(double(NAN)), Error);
}

TEST(HalfScale, OfMapsIsThatOfTheLargestMagnitudeOfAllOfThem) {
    IrradianceMaps kajiya_kay;
    kajiya_kay.face_size = 4;
    kajiya_kay.diffuse.assign(96, Vec3f(1));
    kajiya_kay.specular.assign(3, CubeTexels(96, Vec3f(1)));
    MapSet maps = to_map_set(kajiya_kay, FiberSettings{});
    EXPECT_EQ(half_scale(maps), 1);
    maps.lobes[1].cubes[2][95].z = -1e5f;  // maps by SH may be negative
    EXPECT_EQ(half_scale(maps), 2);
}

}  // namespace
}  // namespace hairbake
