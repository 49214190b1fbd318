// A bake result made by hand: every value is known.
#pragma once

#include "core/result/bake_result.h"

namespace hairbake::test_support {

/// Cube of n x n faces whose texel k holds (k, k + 0.25, -k) + offset.
inline CubeTexels counted_cube(int n, float offset) {
    CubeTexels cube;
    for (int k = 0; k < 6 * n * n; ++k)
        cube.emplace_back(offset + float(k), offset + float(k) + 0.25f, offset - float(k));
    return cube;
}

/// The parts and arrays of the results below, to change them.
inline StagePart& transmittance_of(BakeResult& result) { return result.parts.at(0); }
inline StagePart& irradiance_of(BakeResult& result) { return result.parts.back(); }
inline ErrorBar& error_bar_of(BakeResult& result) {
    return *std::get<TransmittanceFacts>(transmittance_of(result).facts).error_bar;
}

/// 0, step, 2 step ...: so many numbers a row.
inline VertexArray counted_array(const ArrayKind& kind, std::size_t rows, std::size_t components, float step) {
    VertexArray array{&kind, components, {}};
    for (std::size_t i = 0; i < rows * components; ++i) array.values.push_back(step * static_cast<float>(i));
    return array;
}

/// Two strands (3 and 2 points), A = 0, 0.25, 0.5, 0.75, 1; three specular maps of 4x4x6; all outputs.
inline BakeResult small_result() {
    BakeResult result;
    result.request.hair = "two.hair";
    result.request.environment = "sky.hdr";
    result.id = "0123456789abcdef";
    result.inputs.digests = {{"hair", "aa"}, {"environment", "cc"}};
    result.inputs.hair = HairFacts{2, 5, 3, {0, 0, 0}, {1, 2, 0}};

    HairModel model;
    model.strand_begin = {0, 3, 5};
    model.positions = {{0, 0, 0}, {0, 1, 0}, {0, 2, 0}, {1, 0, 0}, {1, 1, 0}};
    model.thickness = {0.1f, 0.2f, 0.3f, 0.4f, 0.5f};
    model.colors = std::vector<Vec3f>(5, Vec3f{0.1f, 0.2f, 0.3f});
    model.default_transparency = 0.125f;
    result.hair = model;

    StagePart transmittance;
    transmittance.stage = find_stage("transmittance");
    transmittance.key = "bb";
    transmittance.arrays = {{&average_transmittance_kind(), 1, {0, 0.25f, 0.5f, 0.75f, 1}}};
    ErrorBar bar;
    bar.outside = {4, 0.003, 0.01, -0.001, {0.008, 0.012}, {-0.002, 0}};
    bar.clear = {2, 0.004, 0.02, 0.005, {0.01, 0.03}, {0, 0.01}};
    bar.inside_strand = 1;
    bar.directions = 4096;
    transmittance.facts = TransmittanceFacts{TransmittanceMethod::volume, "as the request asks", 100, 0.5, VoxelReason::asked, 7, 1, bar, nullptr};
    result.parts.push_back(transmittance);

    EnvironmentMap map;
    map.width = 64;
    map.height = 32;
    map.source_format = "hdr";
    map.repairs.negative_pixels = 3;
    map.repairs.energy_removed = 0.5;
    result.inputs.environment = map;
    IrradianceMaps maps;
    maps.face_size = 4;
    maps.exponent = 64;
    maps.diffuse = counted_cube(4, 0);
    for (int m = 0; m < 3; ++m) maps.specular.push_back(counted_cube(4, 1000.f * float(m + 1)));
    maps.specular_statistics.resize(3);
    StagePart irradiance;
    irradiance.stage = find_stage("irradiance");
    irradiance.key = "dd";
    irradiance.maps = to_map_set(maps, FiberSettings{});
    IrradianceFacts facts;
    facts.environment_sh_bands = 2;
    facts.environment_sh = {{1, 2, 3}, {0.1, 0.2, 0.3}, {1e-20, 0, -5}, {7, 8, 9}};
    irradiance.facts = facts;
    result.parts.push_back(irradiance);
    result.warnings = {"a warning with \"quotes\""};
    return result;
}

}  // namespace hairbake::test_support
