#include "core/output/hair_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hairbake {
namespace {

/// A vertex as the camera sees it: pixels to the right, pixels down, nearness.
struct Seen {
    float x, y, near, value;
};

class Camera {
public:
    Camera(const HairModel& model, View view, int size) : view_(view), size_(size) {
        Vec3d low{1e300, 1e300, 1e300}, high = -low;
        for (const Vec3f& p : model.positions) {
            const Vec3d q = turned(p);
            low = {std::min(low.x, q.x), std::min(low.y, q.y), 0};
            high = {std::max(high.x, q.x), std::max(high.y, q.y), 0};
        }
        middle_ = (low + high) * 0.5;
        const double extent = std::max(high.x - low.x, high.y - low.y);
        scale_ = extent > 0 ? 0.94 * size / extent : 1;
    }

    Seen see(const Vec3f& position, float value) const {
        const Vec3d q = turned(position) - middle_;
        return {static_cast<float>(size_ / 2.0 + q.x * scale_), static_cast<float>(size_ / 2.0 - q.y * scale_),
                static_cast<float>(q.z * scale_), value};
    }

private:
    /// x to the right, y up, z towards the camera.
    Vec3d turned(const Vec3f& p) const {
        return view_ == View::front ? Vec3d(p) : Vec3d{-double(p.z), double(p.y), double(p.x)};
    }

    View view_;
    int size_;
    Vec3d middle_;
    double scale_ = 1;
};

/// Draws points, the nearest wins; of two equally near ones the first.
class DepthPicture {
public:
    explicit DepthPicture(int size)
        : picture{size, std::vector<float>(static_cast<std::size_t>(size) * size, -1)},
          nearest_(picture.value.size(), -std::numeric_limits<float>::infinity()) {}

    void line(const Seen& from, const Seen& to) {
        const float reach = std::max(std::abs(to.x - from.x), std::abs(to.y - from.y));
        const int steps = std::max(1, static_cast<int>(std::ceil(reach)));
        for (int i = 0; i <= steps; ++i) {
            const float f = static_cast<float>(i) / static_cast<float>(steps);
            point({from.x + f * (to.x - from.x), from.y + f * (to.y - from.y), from.near + f * (to.near - from.near),
                   from.value + f * (to.value - from.value)});
        }
    }

    void point(const Seen& p) {
        const int x = static_cast<int>(p.x), y = static_cast<int>(p.y);
        if (x < 0 || y < 0 || x >= picture.size || y >= picture.size) return;
        const std::size_t i = static_cast<std::size_t>(y) * picture.size + x;
        if (p.near <= nearest_[i]) return;
        nearest_[i] = p.near;
        picture.value[i] = p.value;
    }

    HairPicture picture;

private:
    std::vector<float> nearest_;
};

}  // namespace

HairPicture draw_hair(const HairModel& model, std::span<const float> average, View view, int size) {
    const Camera camera(model, view, size);
    DepthPicture depth(size);
    for (std::size_t s = 0; s < model.strand_count(); ++s) {
        const std::uint32_t begin = model.strand_begin[s], end = model.strand_begin[s + 1];
        Seen last = camera.see(model.positions[begin], average[begin]);
        depth.point(last);
        for (std::uint32_t i = begin + 1; i < end; ++i) {
            const Seen next = camera.see(model.positions[i], average[i]);
            depth.line(last, next);
            last = next;
        }
    }
    return std::move(depth.picture);
}

}  // namespace hairbake
