#include "tests/support/transfer_matrix.h"

#include "core/base/spherical_harmonics.h"
#include "core/environment/latlong.h"

namespace hairbake::testing {

std::vector<Vec3d> transfer_matrix_map(const EnvironmentMap& map, std::span<const Vec3d> tangents, int bands,
                                       const std::function<double(double)>& kernel) {
    const ShBasis basis(bands);
    const LatLongRows rows = latlong_rows(map.width, map.height);
    std::vector<double> y(basis.count());
    std::vector<Vec3d> weights(basis.count());
    std::vector<std::vector<double>> transfer(tangents.size(), std::vector<double>(basis.count()));
    for (int row = 0; row < map.height; ++row)
        for (int column = 0; column < map.width; ++column) {
            const Vec3d w = direction_of(map, {column + 0.5, row + 0.5});
            basis.evaluate(w, y);
            const Vec3d flux = Vec3d(map.pixels[std::size_t(row) * map.width + column]) * rows.solid_angle[row];
            for (int i = 0; i < basis.count(); ++i) weights[i] += flux * y[i];
            for (std::size_t k = 0; k < tangents.size(); ++k) {
                const double weighted = kernel(dot(tangents[k], w)) * rows.solid_angle[row];
                for (int i = 0; i < basis.count(); ++i) transfer[k][i] += weighted * y[i];
            }
        }
    std::vector<Vec3d> result(tangents.size());
    for (std::size_t k = 0; k < tangents.size(); ++k)
        for (int i = 0; i < basis.count(); ++i) result[k] += weights[i] * transfer[k][i];
    return result;
}

}  // namespace hairbake::testing
