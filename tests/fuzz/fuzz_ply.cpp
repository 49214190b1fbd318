// Any bytes as a PLY file; the corpus begins with such files, and the bytes decide.
#include "tests/fuzz/mesh_demands.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    hairbake::demand_mesh(std::as_bytes(std::span(data, size)));
    return 0;
}
