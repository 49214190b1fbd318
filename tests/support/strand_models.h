// Small strand models built in code, media of random fibres, and the two ways to bake them.
#pragma once

#include <cstdint>
#include <functional>
#include <numbers>
#include <vector>

#include "core/base/random.h"
#include "core/base/vec.h"
#include "core/hair/strand_geometry.h"
#include "core/volume/transmittance.h"

namespace hairbake::test_support {

/// Collects strands. Widths and opacities are given for each strand.
class StrandModel {
public:
    /// Adds a strand; returns the index of its first vertex.
    std::uint32_t add(const std::vector<Vec3d>& points, double width, double opacity = 1);
    /// Adds strands of one point, which carry no extinction: they are probes. Returns the index of the first.
    std::uint32_t add_probes(const std::vector<Vec3d>& points);
    /// Strands of one point at two opposite corners of a box, so that the bounds are at least that box.
    void add_box(const Vec3d& low, const Vec3d& high);

    std::size_t vertex_count() const { return positions_.size(); }
    /// The geometry, every position passed through `map` and every width multiplied by `width_scale`.
    StrandGeometry geometry(const std::function<Vec3d(const Vec3d&)>& map, double width_scale = 1) const;
    StrandGeometry geometry() const;

private:
    std::vector<std::uint32_t> begin_{0};
    std::vector<Vec3d> positions_;
    std::vector<double> widths_, opacities_;
};

/// `count` + 1 points from a to b at equal steps.
std::vector<Vec3d> straight(const Vec3d& a, const Vec3d& b, int count = 1);

Vec3d random_direction(Random& random);
Vec3d random_point_in_ball(Random& random, double radius);
Vec3d random_point_in_box(Random& random, const Vec3d& low, const Vec3d& high);

/// A convex body, for fibres to be cut off at: the part [t0, t1] of the line p + t d inside it; empty when t0 >= t1.
struct Interval {
    double begin, end;
};
using Body = std::function<Interval(const Vec3d& p, const Vec3d& d)>;
Body ball(double radius);
Body box(const Vec3d& low, const Vec3d& high);

/// Straight fibres of one length, placed uniformly and independently.
struct Fibres {
    double width = 0.01, length = 0.2, opacity = 1;
    /// Optical depth per unit of length in the mean over directions (isotropic fibres) or across (parallel ones).
    double extinction = 1;
    bool parallel_to_z = false;
};

/// Fills `body`, which lies in the box, with fibres cut off at its surface: their length per volume is the same
/// everywhere inside. Their number is the expected one. Isotropic fibres have directions uniform over the sphere:
/// extinction = opacity * width * (length per volume) * pi / 4; parallel ones lack the pi / 4.
void fill(StrandModel& model, const Body& body, const Vec3d& low, const Vec3d& high, const Fibres& fibres,
          Random& random);

/// Proper rotation by `angle` about `axis` (Rodrigues).
std::function<Vec3d(const Vec3d&)> rotation(const Vec3d& axis, double angle);

/// A of every vertex, volume method.
std::vector<float> bake(const StrandGeometry& strands, const TransmittanceSettings& settings = {});
/// Settings of `voxels` on the longest axis, or of a voxel size, and Fibonacci directions.
TransmittanceSettings with_voxels(int voxels, int directions = 100);
TransmittanceSettings with_voxel_size(double size, int directions = 100);

}  // namespace hairbake::test_support
