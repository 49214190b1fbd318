#include "core/output/cube_mips.h"

#include <algorithm>

namespace hairbake {
namespace {

/// The part of a row (or column) of the larger level that one texel of the smaller level covers: the shares, in (0, 1],
/// of two texels from `first` on, or of three where the size was odd.
struct Cover {
    int first = 0;
    std::vector<double> shares;
};

std::vector<Cover> covers_of(int large, int small) {
    std::vector<Cover> covers(small);
    for (int i = 0; i < small; ++i) {
        const double begin = double(i) * large / small, end = double(i + 1) * large / small;
        covers[i].first = i * large / small;
        for (int j = covers[i].first; j < end; ++j)
            covers[i].shares.push_back(std::min(end, j + 1.0) - std::max(begin, double(j)));
    }
    return covers;
}

CubeTexels halved(const CubeTexels& texels, int large, int small) {
    const std::vector<double> solid_angles = cube_texel_solid_angles(large);
    const std::vector<Cover> covers = covers_of(large, small);
    CubeTexels result;
    result.reserve(std::size_t(cube_faces) * small * small);
    for (int face = 0; face < cube_faces; ++face)
        for (const Cover& rows : covers)
            for (const Cover& columns : covers) {
                Vec3d sum;
                double weights = 0;
                for (std::size_t y = 0; y < rows.shares.size(); ++y)
                    for (std::size_t x = 0; x < columns.shares.size(); ++x) {
                        const int row = rows.first + int(y), column = columns.first + int(x);
                        const double weight =
                            rows.shares[y] * columns.shares[x] * solid_angles[cube_texel_index(large, 0, row, column)];
                        sum += weight * Vec3d(texels[cube_texel_index(large, face, row, column)]);
                        weights += weight;
                    }
                result.emplace_back(sum / weights);
            }
    return result;
}

}  // namespace

int mip_level_count(int face_size) {
    int levels = 1;
    for (; face_size > 1; face_size /= 2) ++levels;
    return levels;
}

std::vector<CubeTexels> cube_mips(const CubeTexels& texels, int face_size) {
    std::vector<CubeTexels> levels{texels};
    for (int n = face_size; n > 1; n /= 2) levels.push_back(halved(levels.back(), n, n / 2));
    return levels;
}

}  // namespace hairbake
