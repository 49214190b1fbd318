// Sums of kernels of the angle to a tangent over many lights: the heart of the exact method.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/base/vec.h"
#include "core/environment/light_set.h"

namespace hairbake {

/// Nodes along theta in [0, pi] at which kernels are tabulated: even in s, where |s| = 1 - sqrt(1 - |cos theta|) and s
/// has the sign of cos theta. That is nearly even in theta (steps differ by at most sqrt 2, finest at the poles'
/// opposite, the equator) and costs one square root for a light, no arc cosine. Node 0 is theta = pi, the last one
/// theta = 0.
class AngleGrid {
public:
    /// `intervals` even, >= 2.
    explicit AngleGrid(int intervals) : intervals_(intervals) {}

    /// Fine enough for Kajiya-Kay lobes of `exponent`: linear interpolation of the kernel errs by at most about 2e-4.
    static AngleGrid for_exponent(double exponent);

    int intervals() const { return intervals_; }
    int nodes() const { return intervals_ + 1; }
    double theta(int node) const;
    double largest_step() const;  ///< upper bound of the difference in theta between two nodes

private:
    int intervals_;
};

/// Kernels of theta tabulated at the nodes of a grid, one a row.
class KernelTable {
public:
    explicit KernelTable(AngleGrid grid) : grid_(grid) {}

    void add_row(const std::function<double(double theta)>& kernel);

    const AngleGrid& grid() const { return grid_; }
    int rows() const { return static_cast<int>(spans_.size()); }

    /// Sums a row against a histogram [4 * nodes] (red, green, blue, unused).
    Vec3f apply(int row, std::span<const float> histogram) const;

private:
    struct Span {
        int begin, end;  // nodes outside carry zero
    };
    AngleGrid grid_;
    std::vector<Span> spans_;
    std::vector<float> values_;  // [rows * nodes]
};

/// For each tangent t (unit) and each row K of the table: sum over lights of flux * K(angle(t, light)), with K linear
/// between nodes. Returns [tangents * rows]. A histogram of flux over the angle is made once per tangent, so that the
/// number of kernels hardly matters (all Kajiya-Kay maps depend on the light through its angle to the tangent alone);
/// that is our own way to evaluate Xing 2012, section 3. Single precision inside, relative error about 1e-5. The same
/// bytes for any thread count. Throws Error(cancelled).
std::vector<Vec3f> sum_kernels(const LightSet& lights, std::span<const Vec3d> tangents, const KernelTable& table,
                               const Progress& progress);

}  // namespace hairbake
