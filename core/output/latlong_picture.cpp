#include "core/output/latlong_picture.h"

#include "core/environment/latlong.h"

namespace hairbake {

Picture to_latlong(const CubeTexels& cube, int face_size, int width) {
    Picture picture{width, width / 2, {}};
    picture.pixels.reserve(static_cast<std::size_t>(width) * picture.height);
    const LatLongRows rows = latlong_rows(width, picture.height);
    const LatLongColumns columns = latlong_columns(width);
    for (int row = 0; row < picture.height; ++row)
        for (int column = 0; column < width; ++column) {
            // The polar frame of a gltf map: its z is the world's Y, its x the world's X, its y the world's Z.
            const Vec3d direction{rows.sin_theta[row] * columns.cos_phi[column], rows.cos_theta[row],
                                  rows.sin_theta[row] * columns.sin_phi[column]};
            picture.pixels.emplace_back(sample_cube(cube, face_size, direction));
        }
    return picture;
}

}  // namespace hairbake
