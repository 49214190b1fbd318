#include "core/output/array_files.h"

#include "core/output/format_table.h"
#include "core/output/npy.h"

namespace hairbake {

WrittenFile write_array_npy(const VertexArray& array, const std::filesystem::path& folder) {
    FileSink sink(folder / (std::string(array.kind->name) + ".npy"));
    sink.write(npy_header(array.shape()));
    sink.write(npy_data(array.values));
    WrittenFile written = sink.finish();
    written.shape = array.shape();
    written.content = array.kind->meaning;
    return written;
}

std::vector<WrittenFile> write_map_npy(const MapSet& maps, const std::filesystem::path& folder) {
    const auto n = static_cast<std::size_t>(maps.face_size);
    std::vector<WrittenFile> files;
    for (const MapLobe& lobe : maps.lobes) {
        FileSink sink(folder / (lobe.name + ".npy"));
        std::vector<std::size_t> shape{6, n, n, 3};
        if (lobe.has_slices()) shape.insert(shape.begin(), lobe.cubes.size());
        sink.write(npy_header(shape));
        for (const CubeTexels& cube : lobe.cubes) sink.write(npy_data(cube));
        WrittenFile& written = files.emplace_back(sink.finish());
        written.shape = shape;
        written.content = lobe.name + (lobe.has_slices() ? " maps: theta', " : " map: ") + "face, row, column, RGB";
    }
    return files;
}

std::vector<WrittenFile> write_npy(const OutputContext& context, const StagePart& part) {
    std::vector<WrittenFile> files;
    for (const VertexArray& array : part.arrays) files.push_back(write_array_npy(array, context.folder));
    if (part.maps)
        for (WrittenFile& file : write_map_npy(*part.maps, context.folder)) files.push_back(std::move(file));
    return files;
}

}  // namespace hairbake
