#include "core/output/raw_strands.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>

#include "core/base/bounds.h"
#include "core/hair/tangents.h"
#include "core/output/half.h"
#include "core/output/little_endian.h"

namespace hairbake {
namespace {

using Json = nlohmann::ordered_json;

/// Writes arrays one after the other and collects their entries of strands.json.
class ArrayFile {
public:
    explicit ArrayFile(const std::filesystem::path& file) : sink_(file) {}

    template <class T>
    void add(const char* name, const char* type, const std::vector<std::size_t>& shape, std::span<const T> values) {
        sink_.write(std::string(-offset_ % 8, '\0'));
        offset_ += -offset_ % 8;
        arrays.push_back(
            {{"name", name}, {"type", type}, {"shape", shape}, {"offset", offset_}, {"bytes", values.size_bytes()}});
        sink_.write(std::as_bytes(values));
        offset_ += values.size_bytes();
    }
    WrittenFile finish() { return sink_.finish(); }

    Json arrays = Json::array();

private:
    FileSink sink_;
    std::uint64_t offset_ = 0;
};

std::vector<Half> to_halves(const std::vector<float>& values) {
    std::vector<Half> halves(values.size());
    std::transform(values.begin(), values.end(), halves.begin(), to_half);
    return halves;
}

std::vector<Half4> tangents_and_transmittance(const HairModel& model, const std::vector<float>& average) {
    const std::vector<Vec3f> tangents = vertex_tangents(model);
    std::vector<Half4> halves(tangents.size());
    for (std::size_t i = 0; i < halves.size(); ++i)
        halves[i] = {to_half(tangents[i].x), to_half(tangents[i].y), to_half(tangents[i].z), to_half(average[i])};
    return halves;
}

Json bounds_json(const std::vector<Vec3f>& positions) {
    if (positions.empty()) return nullptr;
    const auto [low, high] = bounds_of(positions);
    return {{low.x, low.y, low.z}, {high.x, high.y, high.z}};
}

}  // namespace

std::vector<WrittenFile> write_strand_raw(const HairModel& model, std::span<const VertexArray> arrays,
                                          const std::filesystem::path& folder) {
    const std::size_t vertices = model.vertex_count();
    const ArrayKind &average = average_transmittance_kind(), &sh = transmittance_sh_kind();
    ArrayFile file(folder / "strands.bin");
    file.add("positions", "float32", {vertices, 3}, std::span(model.positions));
    file.add("strand_begin", "uint32", {model.strand_begin.size()}, std::span(model.strand_begin));
    file.add("tangent_and_transmittance", "float16", {vertices, 4},
             std::span<const Half4>(tangents_and_transmittance(model, find_array(arrays, average)->values)));
    for (const VertexArray& array : arrays)
        if (array.kind->owner == ArrayOwner::hair && array.kind != &average && vertices > 0)
            file.add(std::string(array.kind->name).c_str(), "float16", array.shape(),
                     std::span<const Half>(to_halves(array.values)));

    std::size_t bands = 0;
    if (const VertexArray* harmonics = find_array(arrays, sh); harmonics && vertices > 0)
        while (bands * bands < harmonics->components) ++bands;
    FileSink json(folder / "strands.json");
    const Json page{{"content", "hairbake strands"},
                    {"file", "strands.bin"},
                    {"byte_order", "little"},
                    {"vertices", vertices},
                    {"strands", model.strand_count()},
                    {"bounds", bounds_json(model.positions)},
                    {"sh_bands", bands},
                    {"arrays", file.arrays}};
    json.write(page.dump(2) + "\n");

    std::vector<WrittenFile> files{file.finish(), json.finish()};
    files[0].content = "positions, strands, tangents and A as vertex buffers; strands.json tells the layout";
    files[1].content = "layout and meaning of strands.bin";
    return files;
}

}  // namespace hairbake
