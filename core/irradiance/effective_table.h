// Effective transmittance: the weights that put the light inside the integral (docs/math.md, section 19).
//
// With the published run time A(x) R(t), the transmittance is taken out of the integral. Effective transmittance keeps
// it in: for each vertex there is an Ad with Ad D = sum of T L K_diffuse, exactly, and a series As(theta') = sum of c_j
// cos(j theta') with As S closest to sum of T L K_specular over all angles of view. Both are linear in T. So they are
// sums over the lights of T times a weight that depends on the light and on the vertex's tangent alone.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/environment/light_clusters.h"
#include "core/fiber/fiber_model.h"
#include "core/irradiance/effective_settings.h"

namespace hairbake {

/// A factor for the numbers of lights, texels and angles: sqrt(sharpness / 64), 1 to 4. The sharper the lobe, the more
/// of them it needs; the study behind this method used a sharpness of 64 (Kajiya-Kay's exponent).
double effective_refinement(double sharpness);

/// The weights of every light at every cell of tangents.
struct EffectiveTable {
    int face_size = 0;  ///< the cells are the texels of a cube map of this size, and one more
    std::size_t lights = 0, components = 0;
    std::vector<float> values;  ///< [cells][lights][components]: Ad of each channel, c_0, c_1 ...
    std::vector<Vec3f>
        diffuse;  ///< [cells], D: the diffuse light of all lights together, their flux scaled to the sum 1
    std::vector<float> diffuse_light;  ///< [cells][lights], the luminance of each light's part of it

    std::size_t cells() const { return values.size() / (lights * components); }
    /// The cell of a unit tangent from root to tip; the last one is that of (0, 0, 0), a strand without a direction.
    std::uint32_t cell_of(const Vec3f& tangent) const;
};

/// Fits the weights for these lights.
///
/// With s_k = K_diffuse(t, l_k), kappa_k(theta') = K_specular(t, l_k, theta'), D_c = sum of s_k L_kc, S_c(theta') = sum
/// of kappa_k L_kc, Y the luminance, and sums over theta' weighted by w = sin theta':
///   Ad_c:  s_k L_kc / D_c
///   c_j:   G^-1 B, with G_ij = sum w S_c^2 h_i h_j + lambda d_ij, B_jk = sum w S_c L_kc kappa_k h_j + lambda d_j0 m_k,
///          h_j = cos(j theta'), m_k = s_k Y_k / Y(D), lambda = 0.001 sum w S_c^2
/// where the sums run over theta' and the channels. The flux is scaled to the sum 1 first, so nothing depends on
/// exposure. Where no light reaches a lobe, the weights are those of its prior: m_k, and without any light 1 / lights.
/// T = 1 gives (1, 1, 1, 1, 0, 0). The same for any thread count.
/// Throws Error(cancelled).
EffectiveTable make_effective_table(std::span<const ClusteredLight> lights, const FiberModel& model,
                                    const EffectiveSettings& settings, Progress& progress);

}  // namespace hairbake
