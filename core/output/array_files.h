// Arrays and maps of a result as .npy files.
#pragma once

#include <filesystem>
#include <vector>

#include "core/output/file_sink.h"
#include "core/result/map_set.h"
#include "core/result/vertex_array.h"

namespace hairbake {

/// NAME.npy: float32 of VertexArray::shape().
WrittenFile write_array_npy(const VertexArray& array, const std::filesystem::path& folder);

/// NAME.npy of each lobe, float32: [6, n, n, 3] (face, row, column, RGB), with the slices in front where it has some.
std::vector<WrittenFile> write_map_npy(const MapSet& maps, const std::filesystem::path& folder);

}  // namespace hairbake
