#include "core/irradiance/kernel_sum.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/assert.h"
#include "core/base/parallel.h"

namespace hairbake {
namespace {

using Flux = std::array<float, 4>;

Flux operator+(const Flux& a, const Flux& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]}; }
Flux operator*(const Flux& a, float s) { return {a[0] * s, a[1] * s, a[2] * s, a[3] * s}; }

Flux load(const float* p) { return {p[0], p[1], p[2], p[3]}; }
void store(float* p, const Flux& f) { std::copy(f.begin(), f.end(), p); }

constexpr std::size_t block_size = 512;

// Positions of the lights begin .. begin + count on the grid, in intervals from node 0.
void find_positions(const LightSet& lights, std::size_t begin, std::size_t count, const Vec3f& t, float half,
                    float* positions) {
    const float* x = lights.x.data() + begin;
    const float* y = lights.y.data() + begin;
    const float* z = lights.z.data() + begin;
    for (std::size_t i = 0; i < count; ++i) {
        const float cosine = t.x * x[i] + t.y * y[i] + t.z * z[i];
        const float below_one = 1 - std::abs(cosine);  // rounding may take it below 0
        const float r = std::sqrt(below_one > 0 ? below_one : 0.0f);
        positions[i] = half + std::copysign(half - half * r, cosine);
    }
}

// Adds each light to the two nodes around its angle.
void deposit(const float* flux, std::size_t count, const float* positions, int last_interval, float* histogram) {
    for (std::size_t i = 0; i < count; ++i) {
        const int interval = std::min(static_cast<int>(positions[i]), last_interval);
        const float f = positions[i] - static_cast<float>(interval);
        const Flux light = load(flux + 4 * i);
        float* node = histogram + 4 * static_cast<std::ptrdiff_t>(interval);
        const Flux low = load(node) + light * (1 - f), high = load(node + 4) + light * f;
        store(node, low);
        store(node + 4, high);
    }
}

void make_histogram(const LightSet& lights, const Vec3d& tangent, const AngleGrid& grid, std::span<float> histogram) {
    std::fill(histogram.begin(), histogram.end(), 0.0f);
    std::array<float, block_size> positions;
    for (std::size_t begin = 0; begin < lights.size(); begin += block_size) {
        const std::size_t count = std::min(block_size, lights.size() - begin);
        find_positions(lights, begin, count, Vec3f(tangent), 0.5f * static_cast<float>(grid.intervals()),
                       positions.data());
        deposit(lights.flux.data() + 4 * begin, count, positions.data(), grid.intervals() - 1, histogram.data());
    }
}

}  // namespace

AngleGrid::AngleGrid(int intervals) : intervals_(intervals) { HAIRBAKE_ASSERT(intervals >= 2 && intervals % 2 == 0); }

AngleGrid AngleGrid::for_sharpness(double sharpness) {
    // The error of linear interpolation is step^2 / 8 * largest second derivative; the step is about pi / 1024 at a
    // sharpness of 64.
    return AngleGrid(2 * static_cast<int>(std::ceil(512 * std::sqrt(std::max(1.0, sharpness / 64)))));
}

double AngleGrid::theta(int node) const {
    const double s = 2.0 * node / intervals_ - 1, r = 1 - std::abs(s);  // r = sqrt(2) sin(theta / 2) towards the pole
    const double from_pole = 2 * std::asin(r / std::numbers::sqrt2);
    return s >= 0 ? from_pole : std::numbers::pi - from_pole;
}

double AngleGrid::largest_step() const {
    // d theta / dr = 2 / sqrt(2 - r^2) <= 2 at r = 1; dr = 2 / intervals.
    return 4.0 / intervals_;
}

void KernelTable::add_row(const std::function<double(double)>& kernel) {
    Span span{grid_.nodes(), 0};
    for (int node = 0; node < grid_.nodes(); ++node) {
        const float value = static_cast<float>(kernel(grid_.theta(node)));
        values_.push_back(value);
        if (value == 0) continue;
        span.begin = std::min(span.begin, node);
        span.end = node + 1;
    }
    spans_.push_back(span);
}

Vec3f KernelTable::apply(int row, std::span<const float> histogram) const {
    const float* values = values_.data() + std::size_t(row) * grid_.nodes();
    Flux sums[4]{};  // four chains, so that additions overlap
    int node = spans_[row].begin;
    const int end = spans_[row].end;
    for (; node + 4 <= end; node += 4)
        for (int k = 0; k < 4; ++k) sums[k] = sums[k] + load(&histogram[4 * (node + k)]) * values[node + k];
    for (; node < end; ++node) sums[0] = sums[0] + load(&histogram[4 * node]) * values[node];
    const Flux sum = (sums[0] + sums[2]) + (sums[1] + sums[3]);
    return {sum[0], sum[1], sum[2]};
}

std::vector<Vec3f> sum_kernels(const LightSet& lights, std::span<const Vec3d> tangents, const KernelTable& table,
                               const Progress& progress) {
    std::vector<Vec3f> sums(tangents.size() * table.rows());
    parallel_for(tangents.size(), 16, [&](std::size_t begin, std::size_t end) {
        std::vector<float> histogram(4 * static_cast<std::size_t>(table.grid().nodes()));
        for (std::size_t i = begin; i < end; ++i) {
            progress.check();
            make_histogram(lights, tangents[i], table.grid(), histogram);
            for (int row = 0; row < table.rows(); ++row) sums[i * table.rows() + row] = table.apply(row, histogram);
        }
    });
    return sums;
}

}  // namespace hairbake
