#include <gtest/gtest.h>

#include "core/output/hair_colors.h"
#include "tests/core/output/small_result.h"
#include "tests/support/run_program.h"
#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

TEST(TransmittanceHair, AnIndependentReaderFindsGreyColoursAndNothingElseChanged) {
    const test_support::TemporaryFolder folder;
    const BakeResult result = test_support::small_result();
    write_transmittance_hair(*result.hair, result.parts[0].arrays[0].values, folder / "");
    // The format as Cem Yuksel describes it: a header of 128 bytes, then segments, points, thickness, transparency and
    // colours as the bits 0 to 4 of the word at byte 12 say.
    const auto python = test_support::run_python(R"(
import struct, sys
b = open(sys.argv[1], 'rb').read()
magic, strands, points, bits, segments, thickness, transparency = struct.unpack('<4sIIIIff', b[:28])
assert (magic, strands, points, bits) == (b'HAIR', 2, 5, 1 | 2 | 4 | 16), (magic, strands, points, bits)
assert transparency == 0.125
assert struct.unpack('<2H', b[128:132]) == (2, 1)
positions = struct.unpack('<15f', b[132:192])
assert positions == (0,0,0, 0,1,0, 0,2,0, 1,0,0, 1,1,0)
assert [round(w, 6) for w in struct.unpack('<5f', b[192:212])] == [.1, .2, .3, .4, .5]
assert struct.unpack('<15f', b[212:]) == (0,0,0, .25,.25,.25, .5,.5,.5, .75,.75,.75, 1,1,1)
print('read'))",
                                                 (folder / "transmittance.hair").string());
    EXPECT_EQ(python.output, "read\n");
}

}  // namespace
}  // namespace hairbake
