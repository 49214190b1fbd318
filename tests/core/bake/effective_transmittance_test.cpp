// The stage effective_transmittance: against closed forms, the tracer and itself.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "core/bake.h"
#include "core/base/error.h"
#include "core/environment/light_clusters.h"
#include "core/hair/hair_format_writer.h"
#include "core/hair/tangents.h"
#include "core/irradiance/effective_table.h"
#include "core/reference/tracer.h"
#include "tests/support/small_inputs.h"

namespace hairbake {
namespace {

using test_support::SmallInputs;

BakeRequest request_of(const SmallInputs& inputs) {
    BakeRequest request = inputs.request();
    request.transmittance.reference_vertices = 0;
    request.effective_transmittance.enabled = true;
    return request;
}

BakeResult baked(const BakeRequest& request, int threads = 2) {
    BakeProgress progress;
    return bake(request, threads, progress);
}

const std::vector<float>& values(const BakeResult& result) {
    return result.array(effective_transmittance_kind())->values;
}

const EffectiveFacts& facts(const BakeResult& result) {
    return std::get<EffectiveFacts>(result.part("effective_transmittance")->facts);
}

TEST(EffectiveTransmittance, OfAStrandAloneIsOneWithoutCosines) {
    const SmallInputs inputs;
    BakeRequest request = request_of(inputs);
    HairModel model;
    for (int i = 0; i < 5; ++i) model.positions.emplace_back(float(i), 0.5f * float(i * i), 0);
    model.strand_begin = {0, 5};
    request.hair = (inputs.folder / "one.hair").string();
    write_hair(model, *request.hair);
    request.strand.width = 0.01;
    for (const auto method : {TransmittanceMethod::trace, TransmittanceMethod::automatic}) {
        request.transmittance.method = method;
        const BakeResult result = baked(request);
        const std::vector<float>& row = values(result);
        ASSERT_EQ(row.size(), 5u * 6);
        for (std::size_t i = 0; i < row.size(); ++i) EXPECT_NEAR(row[i], i % 6 <= 3 ? 1 : 0, 1e-5) << i;
    }
}

TEST(EffectiveTransmittance, TracedIsTheSumOverTheLightsOfTheTracedTransmittance) {
    // Independent of the table: Ad = sum T L s / sum L s, with s of the cell's own tangent, and T of single directions.
    const SmallInputs inputs;
    BakeRequest request = request_of(inputs);
    request.transmittance.method = TransmittanceMethod::trace;
    request.effective_transmittance.lights = 4;
    request.irradiance.lights = {{{1, 2, 3}, {5, 4, 3}}};
    const BakeResult result = baked(request);
    ASSERT_EQ(facts(result).lights.size(), 4u * 9 + 1);
    const StrandGeometry strands = make_strand_geometry(*result.hair, request.strand);
    Progress progress;
    const StrandScene scene(strands, progress);
    const std::vector<Vec3f> tangents = vertex_tangents(*result.hair);
    const std::vector<std::uint32_t> some{5, 700, 1500, 2900};
    std::vector<Vec3d> seen(some.size()), open(some.size());
    for (const ClusteredLight& light : facts(result).lights) {
        const Vec3d directions[] = {light.direction};
        const auto t = trace_transmittance(scene, some, directions, progress);
        for (std::size_t i = 0; i < some.size(); ++i) {
            const CubePoint point = cube_point(Vec3d(tangents[some[i]]));
            const auto texel = [](double a) { return std::min(15, int((a + 1) / 2 * 16)); };
            const Vec3d tangent = cube_texel_direction(16, point.face, texel(point.b), texel(point.a));
            const double sine = length(cross(tangent, light.direction));
            open[i] += light.flux * sine;
            seen[i] += light.flux * (sine * double(t[i]));
        }
    }
    for (std::size_t i = 0; i < some.size(); ++i)
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(values(result)[some[i] * 6 + c], seen[i][c] / open[i][c], 1e-5) << i;
}

TEST(EffectiveTransmittance, SweptIsCloseToTraced) {
    // The mean over all vertices: what the mean field errs by at single vertices averages out.
    const SmallInputs inputs;
    BakeRequest request = request_of(inputs);
    request.effective_transmittance.lights = 64;
    const BakeResult swept = baked(request);
    EXPECT_EQ(facts(swept).method, TransmittanceMethod::volume);
    request.transmittance.method = TransmittanceMethod::trace;
    const BakeResult traced = baked(request);
    for (std::size_t c = 0; c < 6; ++c) {
        double difference = 0, vertices = double(values(swept).size()) / 6;
        for (std::size_t i = c; i < values(swept).size(); i += 6)
            difference += double(values(swept)[i]) - double(values(traced)[i]);
        EXPECT_NEAR(difference / vertices, 0, 0.03) << c;
    }
}

TEST(EffectiveTransmittance, IsTheSameForAnyThreadCount) {
    const SmallInputs inputs;
    for (const auto method : {TransmittanceMethod::volume, TransmittanceMethod::trace}) {
        BakeRequest request = request_of(inputs);
        request.transmittance.method = method;
        const std::vector<float> one = values(baked(request, 1));
        for (const int threads : {2, 7}) EXPECT_EQ(values(baked(request, threads)), one);
    }
}

TEST(EffectiveTransmittance, TheLuminanceFormHasFewerNumbers) {
    const SmallInputs inputs;
    BakeRequest request = request_of(inputs);
    request.effective_transmittance.diffuse = EffectiveDiffuse::luminance;
    request.effective_transmittance.cosines = 2;
    const BakeResult result = baked(request);
    EXPECT_EQ(values(result).size(), 3 * result.hair->vertex_count());
    EXPECT_EQ(result.array(effective_transmittance_kind())->shape(),
              (std::vector<std::size_t>{result.hair->vertex_count(), 3}));
}

TEST(EffectiveTransmittance, WithoutLightIsFiniteAndInItsRange) {
    const SmallInputs inputs;
    BakeRequest request = request_of(inputs);
    request.environment_settings.tint = {0, 0, 0};
    const BakeResult result = baked(request);
    const std::vector<float>& row = values(result);
    for (std::size_t i = 0; i < row.size(); ++i) {
        ASSERT_TRUE(std::isfinite(row[i])) << i;
        if (i % 6 > 2) continue;  // the cosines' terms have no range of their own
        EXPECT_GE(row[i], 0);
        EXPECT_LE(row[i], 1);
    }
}

TEST(EffectiveTransmittance, IsRefusedByNameWhereItCannotBeHad) {
    const SmallInputs inputs;
    const auto message = [](const BakeRequest& request) {
        try {
            validate(request);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    BakeRequest request = request_of(inputs);
    request.transmittance.method = TransmittanceMethod::opacity_maps;
    EXPECT_NE(message(request).find("opacity_maps; allowed is true with the methods"), std::string::npos);
    request = request_of(inputs);
    request.environment.reset();
    EXPECT_NE(message(request).find("true without environment"), std::string::npos);
    request = request_of(inputs);
    request.hair.reset();
    EXPECT_NE(message(request).find("true without hair"), std::string::npos);
}

}  // namespace
}  // namespace hairbake
