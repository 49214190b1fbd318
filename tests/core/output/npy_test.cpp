#include "core/output/npy.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/base/error.h"
#include "core/output/array_files.h"
#include "tests/core/output/small_result.h"
#include "tests/support/run_program.h"
#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

using test_support::TemporaryFolder;

TEST(Npy, HeaderIsVersionOneAndEndsAtAMultipleOf64) {
    const std::size_t shape[] = {33, 6, 16, 16, 3};
    const std::string header = npy_header(shape);
    EXPECT_EQ(header.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
    EXPECT_EQ(header.size() % 64, 0u);
    EXPECT_EQ(header.back(), '\n');
    EXPECT_NE(header.find("'shape': (33, 6, 16, 16, 3), }"), std::string::npos);
}

TEST(Npy, NumpyReadsTheMapsAndTheTransmittance) {
    const TemporaryFolder folder;
    const BakeResult result = test_support::small_result();
    write_array_npy(result.parts[0].arrays[0], folder / "");
    write_map_npy(*result.parts[1].maps, folder / "");
    // Texel k of map m holds (k, k + 0.25, -k) + 1000 (m + 1): see small_result.h.
    const auto python = test_support::run_python(R"(
import numpy, sys
f = sys.argv[1]
a = numpy.load(f + '/transmittance.npy'); d = numpy.load(f + '/diffuse.npy'); s = numpy.load(f + '/specular.npy')
assert a.dtype == '<f4' and a.shape == (5,) and a.tolist() == [0, .25, .5, .75, 1]
k = numpy.arange(96).reshape(6, 4, 4)
expected = numpy.stack([k, k + .25, -k], -1)
assert d.dtype == '<f4' and d.flags.c_contiguous and d.shape == (6, 4, 4, 3) and (d == expected).all()
assert s.shape == (3, 6, 4, 4, 3) and all((s[m] == expected + 1000 * (m + 1)).all() for m in range(3))
print('read'))",
                                                 (folder / "").string());
    EXPECT_EQ(python.output, "read\n");
}

TEST(Npy, NumpyReadsHarmonicsBentConesAndTheReceiver) {
    const TemporaryFolder folder;
    const VertexArray arrays[] = {test_support::counted_array(transmittance_sh_kind(), 5, 9, 0.25f),
                                  test_support::counted_array(bent_cone_kind(), 5, 4, -0.5f),
                                  test_support::counted_array(receiver_kind(), 3, 2, 0.125f)};
    for (const VertexArray& array : arrays)
        EXPECT_EQ(write_array_npy(array, folder / "").shape,
                  (std::vector<std::size_t>{array.rows(), array.components}));
    const auto python = test_support::run_python(R"(
import numpy, sys
f = sys.argv[1]
for name, shape, step in ('transmittance_sh', (5, 9), .25), ('bent_cone', (5, 4), -.5), ('receiver', (3, 2), .125):
    a = numpy.load(f + '/' + name + '.npy')
    assert a.dtype == '<f4' and a.flags.c_contiguous and a.shape == shape, name
    assert (a == step * numpy.arange(a.size).reshape(shape)).all(), name
print('read'))",
                                                 (folder / "").string());
    EXPECT_EQ(python.output, "read\n");
}

TEST(Npy, ReadsItsOwnFilesAndThoseOfNumpy) {
    const TemporaryFolder folder;
    write_array_npy({&average_transmittance_kind(), 1, {1, 2, 3}}, folder / "");
    const NpyArray own = read_npy(folder / "transmittance.npy");
    EXPECT_EQ(own.shape, (std::vector<std::size_t>{3}));
    EXPECT_EQ(own.values, (std::vector<float>{1, 2, 3}));
    const auto python = test_support::run_python(
        "import numpy, sys; numpy.save(sys.argv[1], numpy.arange(6, dtype='<f4').reshape(2, 3))",
        (folder / "numpy.npy").string());
    ASSERT_EQ(python.exit_code, 0) << python.output;
    const NpyArray other = read_npy(folder / "numpy.npy");
    EXPECT_EQ(other.shape, (std::vector<std::size_t>{2, 3}));
    EXPECT_EQ(other.values, (std::vector<float>{0, 1, 2, 3, 4, 5}));
}

TEST(Npy, FilesThatLieAreBadInput) {
    const TemporaryFolder folder;
    const std::size_t huge[] = {1000000, 1000000, 1000000}, two[] = {2};
    const std::string eight_bytes(8, '\0');
    const std::pair<const char*, std::string> broken_files[] = {
        {"empty", ""},
        {"magic", "not an array at all, but long enough"},
        {"header_cut", npy_header(two).substr(0, 40)},
        {"data_missing", npy_header(two)},
        {"data_cut", npy_header(two) + "abcdefg"},
        {"too_long", npy_header(two) + eight_bytes + "x"},
        {"huge", npy_header(huge) + eight_bytes},
    };
    for (const auto& [name, bytes] : broken_files) {
        std::ofstream(folder / name, std::ios::binary) << bytes;
        try {
            read_npy(folder / name);
            ADD_FAILURE() << name << " was read";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::bad_input) << name;
            EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
        }
    }
    EXPECT_THROW(read_npy(folder / "missing"), Error);
}

}  // namespace
}  // namespace hairbake
