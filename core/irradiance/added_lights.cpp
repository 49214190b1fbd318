#include "core/irradiance/added_lights.h"

#include <cmath>

#include "core/base/parallel.h"
#include "core/irradiance/tangent_maps.h"

namespace hairbake {

namespace {

std::vector<TangentAngle> view_angles(std::size_t maps) {
    std::vector<TangentAngle> angles;
    for (std::size_t m = 0; m < maps; ++m) {
        const double theta = view_angle(m, maps);
        angles.push_back({std::sin(theta), std::cos(theta)});
    }
    return angles;
}

/// Sums D, then S_0 .. S_M of all lights for one tangent.
void sum_lights(std::span<const DirectionalLight> lights, const Vec3d& tangent, const ZonalKernels& kernels,
                const std::vector<TangentAngle>& views, std::vector<Vec3d>& sums) {
    sums.assign(1 + views.size(), {});
    for (const DirectionalLight& light : lights) {
        const Vec3d direction = normalized(light.direction);
        const TangentAngle angle{length(cross(tangent, direction)), dot(tangent, direction)};
        sums[0] += light.irradiance * kernels.kernel(diffuse_lobe, angle, {});
        for (std::size_t m = 0; m < views.size(); ++m)
            sums[1 + m] += light.irradiance * kernels.kernel(specular_lobe, angle, views[m]);
    }
}

void add(Vec3f& texel, const Vec3d& light) { texel = Vec3f(Vec3d(texel) + light); }

}  // namespace

void add_directional_lights(std::span<const DirectionalLight> lights, const ZonalKernels& kernels,
                            const Progress& progress, IrradianceMaps& maps) {
    if (lights.empty()) return;
    const int n = maps.face_size;
    const std::size_t last = maps.specular.size() - 1;
    const std::vector<TangentAngle> views = view_angles(maps.specular.size());
    // Faces +X, +Y and +Z; the opposite texels follow by symmetry.
    parallel_for(std::size_t(cube_faces / 2) * n, 1, [&](std::size_t row, std::size_t) {
        progress.check();
        std::vector<Vec3d> sums;
        for (int column = 0; column < n; ++column) {
            const int face = 2 * int(row / n), face_row = int(row % n);
            const std::size_t texel = cube_texel_index(n, face, face_row, column), opposite = cube_antipode(n, texel);
            sum_lights(lights, cube_texel_direction(n, face, face_row, column), kernels, views, sums);
            add(maps.diffuse[texel], sums[0]);
            add(maps.diffuse[opposite], sums[0]);
            for (std::size_t m = 0; m <= last; ++m) {
                add(maps.specular[m][texel], sums[1 + m]);
                add(maps.specular[last - m][opposite], sums[1 + m]);
            }
        }
    });
}

LightSet with_directional_lights(LightSet lights, std::span<const DirectionalLight> added) {
    for (const DirectionalLight& light : added) {
        const Vec3f d(normalized(light.direction));
        lights.x.push_back(d.x);
        lights.y.push_back(d.y);
        lights.z.push_back(d.z);
        for (const double channel : {light.irradiance.x, light.irradiance.y, light.irradiance.z, 0.0})
            lights.flux.push_back(static_cast<float>(channel));
        lights.total += light.irradiance;
    }
    return lights;
}

}  // namespace hairbake
