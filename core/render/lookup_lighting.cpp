// The modes that look the transmittance up: from the maps, from the lights, and without light.
#include "core/irradiance/lookup.h"
#include "core/render/fiber_lighting.h"

namespace hairbake {
namespace {

class BakedLighting : public FiberLighting {
public:
    BakedLighting(const VertexTransmittance& transmittance, const IrradianceMaps& maps)
        : transmittance_(transmittance), maps_(maps) {}

    void light(std::span<const StrandPoint> points, std::span<FiberLight> result,
               const Progress& progress) const override {
        progress.check();
        for (std::size_t i = 0; i < points.size(); ++i) {
            const double a = transmittance_.at(points[i].place);
            const FiberView& view = points[i].view;
            result[i] = {a, {}};
            result[i].lobes[diffuse_lobe] = look_up_diffuse(maps_, view.tangent) * a;
            result[i].lobes[specular_lobe] = look_up_specular(maps_, view.tangent, view.to_eye) * a;
        }
    }

private:
    const VertexTransmittance& transmittance_;
    const IrradianceMaps& maps_;
};

class EffectiveLighting : public FiberLighting {
public:
    EffectiveLighting(const EffectiveTransmittance& transmittance, const IrradianceMaps& maps)
        : transmittance_(transmittance), maps_(maps) {}

    void light(std::span<const StrandPoint> points, std::span<FiberLight> result,
               const Progress& progress) const override {
        progress.check();
        for (std::size_t i = 0; i < points.size(); ++i) {
            const FiberView& view = points[i].view;
            const Vec3d diffuse = transmittance_.diffuse_at(points[i].place),
                        light = look_up_diffuse(maps_, view.tangent);
            const double specular = transmittance_.specular_at(points[i].place, dot(view.tangent, view.to_eye));
            const Vec3d arriving{light.x * diffuse.x, light.y * diffuse.y, light.z * diffuse.z};
            const double all = light.x + light.y + light.z;
            result[i] = {all > 0 ? (arriving.x + arriving.y + arriving.z) / all : 0, {}};
            result[i].lobes[diffuse_lobe] = arriving;
            result[i].lobes[specular_lobe] = look_up_specular(maps_, view.tangent, view.to_eye) * specular;
        }
    }

private:
    const EffectiveTransmittance& transmittance_;
    const IrradianceMaps& maps_;
};

class AverageLighting : public FiberLighting {
public:
    explicit AverageLighting(const VertexTransmittance& transmittance) : transmittance_(transmittance) {}

    void light(std::span<const StrandPoint> points, std::span<FiberLight> result,
               const Progress& progress) const override {
        progress.check();
        for (std::size_t i = 0; i < points.size(); ++i) result[i] = {transmittance_.at(points[i].place), {}};
    }

private:
    const VertexTransmittance& transmittance_;
};

class BruteLighting : public FiberLighting {
public:
    BruteLighting(const VertexTransmittance& transmittance, const LightSum& lights)
        : transmittance_(transmittance), lights_(lights) {}

    void light(std::span<const StrandPoint> points, std::span<FiberLight> result,
               const Progress& progress) const override {
        for (std::size_t i = 0; i < points.size(); ++i) {
            progress.check();
            const double a = transmittance_.at(points[i].place);
            result[i] = {a, lights_.sum(points[i].view)};
            for (Vec3d& lobe : result[i].lobes) lobe *= a;
        }
    }

private:
    const VertexTransmittance& transmittance_;
    const LightSum& lights_;
};

}  // namespace

std::unique_ptr<FiberLighting> baked_lighting(const VertexTransmittance& transmittance, const IrradianceMaps& maps) {
    return std::make_unique<BakedLighting>(transmittance, maps);
}

std::unique_ptr<FiberLighting> effective_lighting(const EffectiveTransmittance& transmittance,
                                                  const IrradianceMaps& maps) {
    return std::make_unique<EffectiveLighting>(transmittance, maps);
}

std::unique_ptr<FiberLighting> average_lighting(const VertexTransmittance& transmittance) {
    return std::make_unique<AverageLighting>(transmittance);
}

std::unique_ptr<FiberLighting> brute_lighting(const VertexTransmittance& transmittance, const LightSum& lights) {
    return std::make_unique<BruteLighting>(transmittance, lights);
}

}  // namespace hairbake
