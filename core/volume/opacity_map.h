// One deep opacity map (Yuksel and Keyser 2008; spec, section 3b): in every texel the depth z0 of the first hair and,
// for layers that begin there, the optical depth of all hair before each layer's end.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/hair/strand_geometry.h"
#include "core/volume/opacity_view.h"

namespace hairbake {

/// Strands are lines cut at the texels' edges. A piece of length d across the map adds the coverage
/// width * d * opacity / texel area, as optical depth, to every layer whose end lies behind it; one that crosses a
/// layer's end adds to that layer the share of it that lies before. So the last layer's sum over all texels is the
/// projected area times opacity whatever the resolution.
///
/// Within a texel the optical depth runs from 0 at z0 in straight lines through the ends of the layers and is constant
/// behind the last one; the four texels about a point are blended bilinearly, each with its own z0. A vertex does not
/// see the run of its own strand through these four texels: its coverage is taken out again.
///
/// Reusable: draw() begins anew. Not thread-safe while drawing; look-ups may run side by side.
class OpacityMap {
public:
    /// Draws all solid segments of `strands`, whose vertices lie at `points` ([V], OpacityView::project). `view` must
    /// outlive the look-ups. Throws Error(cancelled).
    void draw(const OpacityView& view, const StrandGeometry& strands, std::span<const LightPoint> points,
              const Progress& progress);

    /// Optical depth between vertex v of the strands drawn last and the light. Never negative.
    float optical_depth(const StrandGeometry& strands, std::span<const LightPoint> points, std::uint32_t v) const;

    /// The same for a point that belongs to no strand and may lie anywhere: beside the map there is no hair.
    float optical_depth(const LightPoint& point) const;

    /// Coverage of a texel summed over its whole depth.
    float coverage(int x, int y) const { return texel(x, y)[view_->layer_end.size()]; }
    const OpacityView& view() const { return *view_; }

    /// Bytes that a map of `settings` takes at most.
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
