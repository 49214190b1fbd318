#include "core/output/raw_strands.h"

#include <gtest/gtest.h>

#include "tests/core/output/small_result.h"
#include "tests/support/run_program.h"
#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

using test_support::small_result;
using test_support::TemporaryFolder;

/// Reads strands.json and the arrays that it names into `a`.
const std::string reader = R"(
import json, pathlib, sys
import numpy as np
folder = pathlib.Path(sys.argv[1])
page = json.loads((folder / 'strands.json').read_text())
data = (folder / page['file']).read_bytes()
assert page['content'] == 'hairbake strands' and page['byte_order'] == 'little'
a = {}
for entry in page['arrays']:
    type = {'float32': '<f4', 'uint32': '<u4', 'float16': '<f2'}[entry['type']]
    assert entry['offset'] % 8 == 0
    a[entry['name']] = np.frombuffer(data, type, entry['bytes'] // np.dtype(type).itemsize,
                                     entry['offset']).reshape(entry['shape'])
assert len(data) == max(e['offset'] + e['bytes'] for e in page['arrays'])
)";

TEST(RawStrands, NumpyFindsPositionsStrandsTangentsAndA) {
    const TemporaryFolder folder;
    const BakeResult result = small_result();
    const auto files = write_strand_raw(*result.hair, result.parts[0].arrays, folder / "");
    EXPECT_EQ(files.size(), 2u);
    EXPECT_EQ(files[0].bytes, std::filesystem::file_size(folder / "strands.bin"));
    const auto python = test_support::run_python(reader + R"(
assert (page['vertices'], page['strands'], page['sh_bands']) == (5, 2, 0)
assert page['bounds'] == [[0, 0, 0], [1, 2, 0]]
assert list(a) == ['positions', 'strand_begin', 'tangent_and_transmittance']
assert a['positions'].tolist() == [[0, 0, 0], [0, 1, 0], [0, 2, 0], [1, 0, 0], [1, 1, 0]]
assert a['strand_begin'].tolist() == [0, 3, 5]
assert a['tangent_and_transmittance'].tolist() == [[0, 1, 0, x] for x in (0, .25, .5, .75, 1)]
print('read'))",
                                                 (folder / "").string());
    EXPECT_EQ(python.output, "read\n");
}

TEST(RawStrands, HoldSphericalHarmonicsAndBentConesWhereTheBakeHasThem) {
    const TemporaryFolder folder;
    BakeResult result = small_result();
    VertexArray sh{&transmittance_sh_kind(), 4, {}}, cone{&bent_cone_kind(), 4, {}};
    for (int i = 0; i < 5 * 4; ++i) sh.values.push_back(static_cast<float>(i) / 10);
    for (int i = 0; i < 5 * 4; ++i) cone.values.push_back(static_cast<float>(-i) / 7);
    result.parts[0].arrays.insert(result.parts[0].arrays.end(), {sh, cone});
    write_strand_raw(*result.hair, result.parts[0].arrays, folder / "");
    const auto python = test_support::run_python(reader + R"(
i = np.arange(20, dtype=np.float32).reshape(5, 4)
assert page['sh_bands'] == 2
assert np.array_equal(a['transmittance_sh'], (i / np.float32(10)).astype(np.float16))
assert np.array_equal(a['bent_cone'], (-i / np.float32(7)).astype(np.float16))
print('read'))",
                                                 (folder / "").string());
    EXPECT_EQ(python.output, "read\n");
}

TEST(RawStrands, OfAnEmptyModelAreEmptyArrays) {
    const TemporaryFolder folder;
    HairModel none;
    none.strand_begin = {0};
    const std::vector<VertexArray> arrays{{&average_transmittance_kind(), 1, {}}};
    write_strand_raw(none, arrays, folder / "");
    const auto python = test_support::run_python(reader + R"(
assert (page['vertices'], page['strands'], page['bounds']) == (0, 0, None)
assert a['positions'].shape == (0, 3) and a['strand_begin'].tolist() == [0]
print('read'))",
                                                 (folder / "").string());
    EXPECT_EQ(python.output, "read\n");
}

}  // namespace
}  // namespace hairbake
