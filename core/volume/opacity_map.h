// One deep opacity map (Yuksel and Keyser 2008; docs/math.md, "Opacity maps").
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/hair/strand_geometry.h"
#include "core/volume/opacity_view.h"

namespace hairbake {

/// Every texel holds the depth z0 of its first hair. Its layers begin there; each holds the optical depth of all hair
/// before the layer's end.
///
/// Drawing: strands are lines cut at the texels' edges. A piece of length d across the map adds the coverage
/// width * d * opacity / texel area, as optical depth, to every layer that ends behind it. A piece that crosses a
/// layer's end adds to that layer only its share before the end. So the sum of the last layer over all texels is the
/// projected area times opacity at any resolution.
///
/// Look-up: within a texel the optical depth is 0 at z0, linear between the ends of the layers, and constant behind the
/// last one. The four texels about a point are blended bilinearly, each with its own z0. The coverage of a vertex's own
/// strand in these four texels is subtracted.
///
/// Reusable: draw() starts again. Not thread-safe while drawing; look-ups may run in several threads.
class OpacityMap {
public:
    /// Draws all solid segments of `strands`.
    ///
    /// view:   must outlive the look-ups
    /// points: [V], the vertices as view.project() gives them
    ///
    /// Throws Error(cancelled).
    void draw(const OpacityView& view, const StrandGeometry& strands, std::span<const LightPoint> points,
              const Progress& progress);

    /// Optical depth between vertex v of the strands drawn last and the light. Never negative.
    float optical_depth(const StrandGeometry& strands, std::span<const LightPoint> points, std::uint32_t v) const;

    /// The same for a point that belongs to no strand and may lie anywhere. Beside the map there is no hair.
    float optical_depth(const LightPoint& point) const;

    /// Coverage of a texel summed over its whole depth.
    float coverage(int x, int y) const { return texel(x, y)[view_->layer_end.size()]; }
    const OpacityView& view() const { return *view_; }

    /// The largest size of a map of `settings`, in bytes.
    static std::uint64_t bytes(const OpacityMapSettings& settings);

private:
    struct Footprint;

    std::size_t place(int x, int y) const {
        return (static_cast<std::size_t>(y) * static_cast<std::size_t>(view_->width) + static_cast<std::size_t>(x)) *
               (1 + view_->layer_end.size());
    }
    const float* texel(int x, int y) const { return &texels_[place(x, y)]; }
    Footprint footprint(const LightPoint& point) const;
    float own_depth(const StrandGeometry& strands, std::span<const LightPoint> points, std::uint32_t v,
                    const Footprint& footprint) const;

    const OpacityView* view_ = nullptr;
    /// [height * width * (1 + layers)]: a texel's z0 (infinite without hair), then the optical depth before each
    /// layer's end.
    std::vector<float> texels_;
};

}  // namespace hairbake
