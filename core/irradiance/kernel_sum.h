// Sums of zonal kernels over many lights: the innermost loop of the exact method.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/base/vec.h"
#include "core/environment/light_set.h"

namespace hairbake {

/// Nodes along theta in [0, pi] at which kernels are tabulated. They are evenly spaced in s, where |s| = 1 - sqrt(1 -
/// |cos theta|) and s has the sign of cos theta. That is nearly even in theta: steps differ by at most a factor sqrt 2
/// and are finest at the equator. The position of a light costs one square root and no arc cosine. Node 0 is theta =
/// pi, the last node theta = 0.
class AngleGrid {
public:
    /// `intervals` even, >= 2.
    explicit AngleGrid(int intervals);

    /// Fine enough for lobes of this sharpness (fiber_model.h): linear interpolation of the kernel errs by at most
    /// about 2e-4 of its peak.
    static AngleGrid for_sharpness(double sharpness);

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

    /// Sum over the nodes of a row times a histogram [4 * nodes] (red, green, blue, unused).
    Vec3f apply(int row, std::span<const float> histogram) const;

private:
    struct Span {
        int begin, end;  // nodes outside are zero
    };
    AngleGrid grid_;
    std::vector<Span> spans_;
    std::vector<float> values_;  // [rows * nodes]
};

/// For each tangent t (unit) and each row K of the table: the sum over the lights of flux * K(angle(t, light)), with K
/// linear between nodes. Returns [tangents * rows].
/// All zonal maps depend on a light through its angle to the tangent alone. A histogram of flux over that angle is
/// therefore made once per tangent, and the number of kernels hardly changes the time. Single precision inside,
/// relative error about 1e-5. The same bytes for any thread count.
/// Throws Error(cancelled).
std::vector<Vec3f> sum_kernels(const LightSet& lights, std::span<const Vec3d> tangents, const KernelTable& table,
                               const Progress& progress);

}  // namespace hairbake
