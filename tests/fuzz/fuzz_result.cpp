// A result folder whose files are any bytes at all: refused as bad input, or read. The first byte names the file that
// the rest is: the manifest, or one of the .npy files. A .npy file lies beside a manifest that gives its digest, so
// that its bytes are read.
#include <array>
#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>

#include "core/base/digest.h"
#include "core/base/error.h"
#include "core/result_reader.h"
#include "tests/fuzz/demand.h"
#include "tests/support/temporary_folder.h"

namespace {

using namespace hairbake;

void put(const std::filesystem::path& file, std::string_view bytes) {
    std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

std::string manifest_with(const std::string& name, std::string_view bytes) {
    return R"({"format": "hairbake result", "inputs": {}, "request": {"hair": "a.hair", "environment": "b.hdr",
               "transmittance": {"sh_bands": 1}, "irradiance": {"face_size": 4, "specular_maps": 2}},
               "files": [{"name": ")" +
           name + R"(", "sha256": ")" + Digest().add(bytes).hex() + "\"}]}";
}

void check_result(const StoredResult& result) {
    for (const VertexArray& array : result.arrays) {
        demand(array.values.size() == array.rows() * array.components, "rows are whole");
        for (const float value : array.values)
            demand(!array.kind->is_share || (value >= 0 && value <= 1), "shares are 0 to 1");
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const test_support::TemporaryFolder folder;
    constexpr std::array<const char*, 5> names{"transmittance.npy", "transmittance_sh.npy", "bent_cone.npy",
                                               "diffuse.npy", "specular.npy"};
    if (size == 0) return 0;
    const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
    const std::size_t choice = data[0] % (names.size() + 1);
    if (choice == names.size()) {
        put(folder / "manifest.json", bytes);
    } else {
        put(folder / names[choice], bytes);
        put(folder / "manifest.json", manifest_with(names[choice], bytes));
    }
    try {
        check_result(read_result(folder / ""));
    } catch (const Error& error) {
        demand(error.kind() == ErrorKind::bad_input, "an input's fault is bad_input");
    }
    return 0;
}
