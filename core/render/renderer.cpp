#include "core/render/renderer.h"

#include <algorithm>
#include <atomic>
#include <numbers>

#include "core/base/assert.h"
#include "core/base/parallel.h"
#include "core/environment/environment_filter.h"
#include "core/render/pixel_samples.h"

namespace hairbake {
namespace {

constexpr int tile_side = 8;  // small: a tile of many samples and lights must not take long

constexpr std::size_t most_points = 16384;  // that wait to be lit; bounds the memory for many samples a pixel

/// One tile of the picture. The strand points of its pixels are lit together.
class Tile {
public:
    Tile(const RenderScene& scene, const Camera& camera, const FrameSettings& settings, int left, int top)
        : scene_(scene),
          camera_(camera),
          settings_(settings),
          left_(left),
          top_(top),
          width_(std::min(tile_side, settings.width - left)),
          height_(std::min(tile_side, settings.height - top)),
          sum_(static_cast<std::size_t>(width_) * height_) {}

    void render(const Progress& progress, std::vector<Vec3f>& picture) {
        for (int y = 0; y < height_; ++y)
            for (int x = 0; x < width_; ++x) {
                sample_pixel(x, y);
                if (points_.size() >= most_points) light_points(progress);
            }
        light_points(progress);
        for (int y = 0; y < height_; ++y)
            for (int x = 0; x < width_; ++x)
                picture[static_cast<std::size_t>(top_ + y) * settings_.width + left_ + x] =
                    Vec3f(sum_[static_cast<std::size_t>(y) * width_ + x] / double(settings_.samples));
    }

private:
    void light_points(const Progress& progress) {
        light_.resize(points_.size());
        scene_.lighting.light(points_, light_, progress);
        for (std::size_t i = 0; i < points_.size(); ++i) sum_[pixel_[i]] += value_of(points_[i], light_[i]);
        points_.clear();
        pixel_.clear();
    }

    void sample_pixel(int x, int y) {
        const auto pixel = static_cast<std::uint64_t>(top_ + y) * settings_.width + left_ + x;
        const std::size_t here = static_cast<std::size_t>(y) * width_ + x;
        const double aspect = double(settings_.width) / settings_.height;
        const PixelSamples samples(settings_.seed, pixel, settings_.samples);
        for (int k = 0; k < settings_.samples; ++k) {
            const PixelPoint point = samples.point(k);
            const Vec3d direction = camera_.direction(2 * (left_ + x + point.x) / settings_.width - 1,
                                                      1 - 2 * (top_ + y + point.y) / settings_.height, aspect);
            const FirstHit hit = scene_.hits.find(camera_.eye, direction);
            if (hit.kind == FirstHit::Kind::strand) {
                points_.push_back({hit.strand,
                                   {tangent_at(hit.strand), -direction},
                                   sample_seed(settings_.seed + 1, pixel, static_cast<std::uint64_t>(k))});
                pixel_.push_back(here);
            } else if (settings_.channel == Channel::beauty) {
                sum_[here] += hit.kind == FirstHit::Kind::mesh ? mesh_radiance(hit.normal) : background(direction);
            }
        }
    }

    /// The tangent, linear between the vertices. Where their tangents cancel, it is the direction of the segment.
    Vec3d tangent_at(const StrandPlace& place) const {
        const std::uint32_t v = place.vertex;
        const Vec3d between = Vec3d(scene_.tangents[v]) * (1 - place.u) + Vec3d(scene_.tangents[v + 1]) * place.u;
        if (length(between) > 1e-3) return normalized(between);
        return normalized(Vec3d(scene_.strands.positions[v + 1]) - Vec3d(scene_.strands.positions[v]));
    }

    Vec3d mesh_radiance(const Vec3d& normal) const {
        if (!scene_.mesh_lights) return {};
        return scene_.mesh_albedo * scene_.mesh_lights->irradiance(normal) / std::numbers::pi;
    }

    Vec3d background(const Vec3d& direction) const {
        return scene_.background ? filtered_radiance(*scene_.background, direction) : Vec3d();
    }

    /// Light through the lobes of one role, Kd or Ks applied.
    Vec3d lobes_of(const FiberLight& light, LobeRole role) const {
        Vec3d sum;
        for (std::size_t k = 0; k < scene_.lobes.size(); ++k)
            if (scene_.lobes[k].role == role) sum += light.lobes[k];
        return sum * (role == LobeRole::diffuse ? scene_.kd : scene_.ks);
    }

    Vec3d value_of(const StrandPoint& point, const FiberLight& light) const {
        switch (settings_.channel) {
            case Channel::beauty:
                return lobes_of(light, LobeRole::diffuse) + lobes_of(light, LobeRole::specular);
            case Channel::transmittance:
                return Vec3d(light.transmittance);
            case Channel::diffuse:
                return lobes_of(light, LobeRole::diffuse);
            case Channel::specular:
                return lobes_of(light, LobeRole::specular);
            case Channel::tangent:
                return point.view.tangent;
        }
        return {};
    }

    const RenderScene& scene_;
    const Camera& camera_;
    const FrameSettings& settings_;
    int left_, top_, width_, height_;
    std::vector<Vec3d> sum_;
    std::vector<StrandPoint> points_;
    std::vector<std::size_t> pixel_;  // of points_
    std::vector<FiberLight> light_;
};

}  // namespace

std::vector<Vec3f> render_frame(const RenderScene& scene, const Camera& camera, const FrameSettings& settings,
                                Progress& progress) {
    HAIRBAKE_ASSERT(settings.width >= 1 && settings.width <= 16384 && settings.height >= 1 && settings.height <= 16384);
    HAIRBAKE_ASSERT(settings.samples >= 1 && settings.samples <= 65536 && scene.lobes.size() <= most_lobes);
    const int columns = (settings.width + tile_side - 1) / tile_side;
    const std::size_t tiles = static_cast<std::size_t>(columns) * ((settings.height + tile_side - 1) / tile_side);
    std::vector<Vec3f> picture(static_cast<std::size_t>(settings.width) * settings.height);
    std::atomic<std::size_t> done{0};
    parallel_for(tiles, 1, [&](std::size_t k, std::size_t) {
        progress.check();
        Tile tile(scene, camera, settings, static_cast<int>(k % columns) * tile_side,
                  static_cast<int>(k / columns) * tile_side);
        tile.render(progress, picture);
        progress.report(double(++done) / double(tiles));
    });
    return picture;
}

}  // namespace hairbake
