#include "core/irradiance/effective_table.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numbers>

#include "core/base/assert.h"
#include "core/base/luminance.h"
#include "core/base/parallel.h"
#include "core/environment/cube_map.h"

namespace hairbake {
namespace {

using std::numbers::pi;

constexpr int texels_at_64 = 16, nodes_at_64 = 91, light_angles_at_64 = 1024;
constexpr double ridge = 1e-3, tiny = 1e-24;
constexpr std::size_t most_cosines = 5;

/// K_specular at every node of theta', for angles of the light on an even grid. Linear between them: at Kajiya-Kay's
/// exponent p the step h = pi / (1024 sqrt(p / 64)) errs by p h^2 / 8 = 8e-5 of the peak.
class SpecularTable {
public:
    SpecularTable(const ZonalKernels& kernels, std::size_t angles, std::size_t nodes)
        : nodes_(nodes), step_(pi / double(angles)) {
        for (std::size_t a = 0; a <= angles; ++a)
            for (std::size_t i = 0; i < nodes; ++i)
                values_.push_back(kernels.kernel(specular_lobe, step_ * double(a), theta_prime(i, nodes)));
    }
    static double theta_prime(std::size_t node, std::size_t nodes) { return pi * double(node) / double(nodes - 1); }

    /// [nodes] at the light's angle `theta`.
    void at(double theta, std::span<double> kernel) const {
        const double place = theta / step_;
        const std::size_t low = std::min(static_cast<std::size_t>(place), values_.size() / nodes_ - 2);
        const double f = place - double(low);
        const double *below = &values_[low * nodes_], *above = below + nodes_;
        for (std::size_t i = 0; i < nodes_; ++i) kernel[i] = below[i] * (1 - f) + above[i] * f;
    }

private:
    std::size_t nodes_;
    double step_;
    std::vector<double> values_;
};

/// What all cells share.
struct Fit {
    const ZonalKernels& kernels;
    const EffectiveSettings& settings;
    std::vector<Vec3d> direction, flux;  ///< scaled to a sum of 1
    std::size_t nodes;
    SpecularTable specular;
    std::vector<std::array<double, most_cosines>> cosine;  ///< [nodes], h_j
    std::vector<double> sine;                              ///< [nodes], w

    Fit(std::span<const ClusteredLight> lights, const ZonalKernels& zonal, const EffectiveSettings& wanted,
        double refinement)
        : kernels(zonal),
          settings(wanted),
          nodes(static_cast<std::size_t>(std::lround((nodes_at_64 - 1) * refinement)) + 1),
          specular(zonal, static_cast<std::size_t>(std::lround(light_angles_at_64 * refinement)), nodes) {
        double sum = 0;
        for (const ClusteredLight& light : lights) sum += light.flux.x + light.flux.y + light.flux.z;
        for (const ClusteredLight& light : lights) {
            direction.push_back(light.direction);
            flux.push_back(sum > 0 ? light.flux / sum : Vec3d());
        }
        for (std::size_t i = 0; i < nodes; ++i) {
            const double theta = SpecularTable::theta_prime(i, nodes);
            auto& h = cosine.emplace_back();
            for (std::size_t j = 0; j < most_cosines; ++j) h[j] = std::cos(double(j) * theta);
            sine.push_back(std::sin(theta));
        }
    }
    std::size_t lights() const { return direction.size(); }
};

/// Buffers of one thread.
struct Scratch {
    std::vector<double> diffuse;  ///< [lights], s_k
    std::vector<double> kappa;    ///< [lights][nodes]
    std::vector<Vec3d> specular;  ///< [nodes], w S_c
};

/// The share of each light in the luminance of the diffuse lobe; equal shares where there is none.
std::vector<double> priors(const Fit& fit, std::span<const double> diffuse) {
    std::vector<double> shares;
    double sum = 0;
    for (std::size_t k = 0; k < fit.lights(); ++k) {
        shares.push_back(diffuse[k] * luminance(fit.flux[k]));
        sum += shares.back();
    }
    for (double& share : shares) share = sum > 0 ? share / sum : 1 / double(fit.lights());
    return shares;
}

/// Sets the unblocked diffuse light of a cell.
void store_light(const Fit& fit, std::span<const double> diffuse, Vec3f& all, float* of_lights) {
    Vec3d sum;
    for (std::size_t k = 0; k < fit.lights(); ++k) {
        sum += fit.flux[k] * diffuse[k];
        of_lights[k] = static_cast<float>(luminance(fit.flux[k]) * diffuse[k]);
    }
    all = Vec3f(sum);
}

void store_diffuse(const Fit& fit, std::span<const double> diffuse, std::span<const double> prior, float* values) {
    const auto stride = static_cast<std::size_t>(fit.settings.components());
    if (fit.settings.diffuse == EffectiveDiffuse::luminance) {
        for (std::size_t k = 0; k < fit.lights(); ++k) values[k * stride] = static_cast<float>(prior[k]);
        return;
    }
    Vec3d sum;
    for (std::size_t k = 0; k < fit.lights(); ++k) sum += fit.flux[k] * diffuse[k];
    for (std::size_t k = 0; k < fit.lights(); ++k)
        for (int c = 0; c < 3; ++c)
            values[k * stride + static_cast<std::size_t>(c)] =
                static_cast<float>(sum[c] > 0 ? diffuse[k] * fit.flux[k][c] / sum[c] : prior[k]);
}

using Column = std::array<double, most_cosines>;
using Matrix = std::array<Column, most_cosines>;

/// Solves G x = b for a symmetric positive definite G of n rows, whose lower half becomes its Cholesky factor.
void factorize(Matrix& g, std::size_t n) {
    for (std::size_t j = 0; j < n; ++j) {
        for (std::size_t k = 0; k < j; ++k) g[j][j] -= g[j][k] * g[j][k];
        g[j][j] = std::sqrt(g[j][j]);
        for (std::size_t i = j + 1; i < n; ++i) {
            for (std::size_t k = 0; k < j; ++k) g[i][j] -= g[i][k] * g[j][k];
            g[i][j] /= g[j][j];
        }
    }
}

Column solve(const Matrix& factor, Column b, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t k = 0; k < i; ++k) b[i] -= factor[i][k] * b[k];
        b[i] /= factor[i][i];
    }
    for (std::size_t i = n; i-- > 0;) {
        for (std::size_t k = i + 1; k < n; ++k) b[i] -= factor[k][i] * b[k];
        b[i] /= factor[i][i];
    }
    return b;
}

/// Sets scratch.specular to w S_c of the nodes and returns G with its ridge, and lambda.
std::pair<Matrix, double> normal_matrix(const Fit& fit, Scratch& scratch) {
    const auto n = static_cast<std::size_t>(fit.settings.cosines);
    Matrix g{};
    for (std::size_t i = 0; i < fit.nodes; ++i) {
        Vec3d s;
        for (std::size_t k = 0; k < fit.lights(); ++k) s += fit.flux[k] * scratch.kappa[k * fit.nodes + i];
        scratch.specular[i] = s * fit.sine[i];
        const double weight = dot(s, s) * fit.sine[i];
        for (std::size_t a = 0; a < n; ++a)
            for (std::size_t b = 0; b <= a; ++b) g[a][b] += weight * fit.cosine[i][a] * fit.cosine[i][b];
    }
    const double lambda = ridge * g[0][0] + tiny;  // h_0 = 1
    for (std::size_t a = 0; a < n; ++a) g[a][a] += lambda;
    return {g, lambda};
}

void store_specular(const Fit& fit, Scratch& scratch, std::span<const double> prior, float* values) {
    const auto n = static_cast<std::size_t>(fit.settings.cosines);
    const auto first = static_cast<std::size_t>(fit.settings.diffuse_components()), stride = first + n;
    auto [g, lambda] = normal_matrix(fit, scratch);
    factorize(g, n);
    for (std::size_t k = 0; k < fit.lights(); ++k) {
        Column b{};
        const double* kappa = &scratch.kappa[k * fit.nodes];
        for (std::size_t i = 0; i < fit.nodes; ++i) {
            const double product = dot(scratch.specular[i], fit.flux[k]) * kappa[i];
            for (std::size_t j = 0; j < n; ++j) b[j] += product * fit.cosine[i][j];
        }
        b[0] += lambda * prior[k];
        const Column c = solve(g, b, n);
        for (std::size_t j = 0; j < n; ++j) values[k * stride + first + j] = static_cast<float>(c[j]);
    }
}

void fit_cell(const Fit& fit, const Vec3d& tangent, Scratch& scratch, float* values) {
    for (std::size_t k = 0; k < fit.lights(); ++k) {
        const double theta = std::acos(std::clamp(dot(tangent, fit.direction[k]), -1.0, 1.0));
        scratch.diffuse[k] = fit.kernels.kernel(diffuse_lobe, theta, 0);
        fit.specular.at(theta, std::span(scratch.kappa).subspan(k * fit.nodes, fit.nodes));
    }
    const std::vector<double> prior = priors(fit, scratch.diffuse);
    store_diffuse(fit, scratch.diffuse, prior, values);
    store_specular(fit, scratch, prior, values);
}

/// The cell of the tangent (0, 0, 0): as if every light shone across the strand, and without a highlight.
void fit_without_tangent(const Fit& fit, Scratch& scratch, float* values) {
    std::fill(scratch.diffuse.begin(), scratch.diffuse.end(), 1.0);
    std::fill(scratch.kappa.begin(), scratch.kappa.end(), 0.0);
    const std::vector<double> prior = priors(fit, scratch.diffuse);
    store_diffuse(fit, scratch.diffuse, prior, values);
    store_specular(fit, scratch, prior, values);
}

}  // namespace

double effective_refinement(double sharpness) { return std::clamp(std::sqrt(sharpness / 64), 1.0, 4.0); }

std::uint32_t EffectiveTable::cell_of(const Vec3f& tangent) const {
    if (tangent == Vec3f()) return static_cast<std::uint32_t>(cells() - 1);
    return static_cast<std::uint32_t>(cube_texel_of(face_size, Vec3d(tangent)));
}

EffectiveTable make_effective_table(std::span<const ClusteredLight> lights, const FiberModel& model,
                                    const EffectiveSettings& settings, Progress& progress) {
    HAIRBAKE_ASSERT(model.zonal_kernels() && !lights.empty() && std::size_t(settings.cosines) <= most_cosines);
    const double refinement = effective_refinement(model.sharpness());
    const Fit fit(lights, *model.zonal_kernels(), settings, refinement);
    EffectiveTable table;
    table.face_size = static_cast<int>(std::lround(texels_at_64 * refinement));
    table.lights = lights.size();
    table.components = static_cast<std::size_t>(settings.components());
    const std::size_t face = std::size_t(table.face_size) * table.face_size, texels = cube_faces * face;
    const std::size_t per_cell = table.lights * table.components;
    table.values.resize((texels + 1) * per_cell);
    table.diffuse.resize(texels + 1);
    table.diffuse_light.resize((texels + 1) * table.lights);
    std::atomic<std::size_t> done{0};
    parallel_for(texels + 1, 64, [&](std::size_t begin, std::size_t end) {
        progress.check();
        Scratch scratch{std::vector<double>(fit.lights()), std::vector<double>(fit.lights() * fit.nodes),
                        std::vector<Vec3d>(fit.nodes)};
        for (std::size_t i = begin; i < end; ++i) {
            float* values = table.values.data() + i * per_cell;
            const int within = static_cast<int>(i % face), row = within / table.face_size;
            if (i == texels)
                fit_without_tangent(fit, scratch, values);
            else
                fit_cell(
                    fit,
                    cube_texel_direction(table.face_size, static_cast<int>(i / face), row, within % table.face_size),
                    scratch, values);
            store_light(fit, scratch.diffuse, table.diffuse[i], &table.diffuse_light[i * table.lights]);
        }
        progress.report(double(done += end - begin) / double(texels + 1));
    });
    return table;
}

}  // namespace hairbake
