#include "core/irradiance/exact_maps.h"

#include <algorithm>
#include <span>

#include "core/base/assert.h"
#include "core/irradiance/added_lights.h"
#include "core/irradiance/interpolation_bound.h"
#include "core/irradiance/kernel_sum.h"

namespace hairbake {
namespace {

constexpr int bounded_face_size = 16;  // coarser cubes would make the bound needlessly loose

/// Row 0 is the diffuse lobe, row 1 + m the specular one at theta'_m.
KernelTable table_of(const FiberModel& model, int specular_maps) {
    const ZonalKernels& kernels = *model.zonal_kernels();
    KernelTable table(AngleGrid::for_sharpness(model.sharpness()));
    table.add_row([&](double theta) { return kernels.kernel(diffuse_lobe, theta, 0); });
    for (int m = 0; m < specular_maps; ++m) {
        const double theta_view = view_angle(m, specular_maps);
        // Below 1e-12 of the peak nothing reaches single precision.
        table.add_row([&](double theta) {
            const double k = kernels.kernel(specular_lobe, theta, theta_view);
            return k < 1e-12 ? 0 : k;
        });
    }
    return table;
}

/// Stores one texel of every map and the opposite texel.
void store_texel(const Vec3f* sums, std::size_t texel, TangentMaps& maps) {
    const std::size_t opposite = cube_antipode(maps.face_size, texel), last = maps.specular.size() - 1;
    maps.diffuse[texel] = maps.diffuse[opposite] = sums[0];
    for (std::size_t m = 0; m <= last; ++m) maps.specular[m][texel] = maps.specular[last - m][opposite] = sums[1 + m];
}

/// The larger of `bound` and the largest sum of an interpolation row over the tangents. `added` are the sums of the
/// directional lights, which are summed apart.
Vec3d larger_bound(Vec3d bound, std::span<const Vec3f> sums, std::span<const Vec3f> added, int rows, int first_bound) {
    for (std::size_t i = 0; i < sums.size(); ++i) {
        if (int(i % rows) < first_bound) continue;
        const Vec3d sum = added.empty() ? Vec3d(sums[i]) : Vec3d(sums[i]) + Vec3d(added[i]);
        for (int channel = 0; channel < 3; ++channel) bound[channel] = std::max(bound[channel], sum[channel]);
    }
    return bound;
}

}  // namespace

ExactMaps bake_exact_maps(const LightSet& lights, const IrradianceSettings& settings, const FiberModel& model,
                          Progress& progress) {
    HAIRBAKE_ASSERT(model.zonal_kernels() && model.is_symmetric_root_tip());
    const ZonalKernels& kernels = *model.zonal_kernels();
    const int n = settings.face_size, count = settings.specular_maps;
    const bool bounded_here = n >= bounded_face_size;
    KernelTable table = table_of(model, count);
    if (bounded_here) add_interpolation_rows(table, kernels, count, texel_radius(n) + lights.radius);
    ExactMaps baked{TangentMaps(n, count), {}};
    const std::size_t texels = std::size_t(n) * n;
    std::vector<Vec3d> tangents(texels);
    const LightSet added = with_directional_lights({}, settings.lights);
    for (const int face : {0, 2, 4}) {
        for (std::size_t i = 0; i < texels; ++i) tangents[i] = cube_texel_direction(n, face, int(i / n), int(i % n));
        const std::vector<Vec3f> sums = sum_kernels(lights, tangents, table, progress);
        std::vector<Vec3f> added_sums;
        if (added.size() > 0) added_sums = sum_kernels(added, tangents, table, progress);
        for (std::size_t i = 0; i < texels; ++i)
            store_texel(sums.data() + i * table.rows(), face * texels + i, baked.maps);
        baked.interpolation_bound = larger_bound(baked.interpolation_bound, sums, added_sums, table.rows(), 1 + count);
        progress.report((face / 2 + 1) / 3.0);
    }
    if (!bounded_here)
        baked.interpolation_bound =
            interpolation_bound(with_directional_lights(lights, settings.lights), kernels, count, progress);
    return baked;
}

}  // namespace hairbake
