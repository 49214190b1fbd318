// A bake result made by hand: every value is known.
#pragma once

#include "core/bake_result.h"

namespace hairbake::test_support {

/// Cube of n x n faces whose texel k holds (k, k + 0.25, -k) + offset.
inline CubeTexels counted_cube(int n, float offset) {
    CubeTexels cube;
    for (int k = 0; k < 6 * n * n; ++k)
        cube.emplace_back(offset + float(k), offset + float(k) + 0.25f, offset - float(k));
    return cube;
}

/// Two strands (3 and 2 points), A = 0, 0.25, 0.5, 0.75, 1; three specular maps of 4x4x6; all outputs.
inline BakeResult small_result() {
    BakeResult result;
    result.request.hair = "two.hair";
    result.request.environment = "sky.hdr";
    result.id = "0123456789abcdef";
    result.digests = {{"hair", "aa"}, {"environment", "cc"}};
    result.keys = {{"transmittance", "bb"}, {"irradiance", "dd"}};
    result.hair_facts = {2, 5, 3, 1, {0, 0, 0}, {1, 2, 0}};

    HairModel model;
    model.strand_begin = {0, 3, 5};
    model.positions = {{0, 0, 0}, {0, 1, 0}, {0, 2, 0}, {1, 0, 0}, {1, 1, 0}};
    model.thickness = {0.1f, 0.2f, 0.3f, 0.4f, 0.5f};
    model.colors = std::vector<Vec3f>(5, Vec3f{0.1f, 0.2f, 0.3f});
    model.default_transparency = 0.125f;
    result.hair = model;

    Transmittance transmittance;
    transmittance.average = {0, 0.25f, 0.5f, 0.75f, 1};
    transmittance.directions = 100;
    transmittance.voxel_size = 0.5;
    transmittance.occupied_voxels = 7;
    result.transmittance = transmittance;
    ErrorBar bar;
    bar.vertices = 4;
    bar.inside_strand = 1;
    bar.directions = 1024;
    bar.rmse = 0.01;
    bar.bias = -0.001;
    bar.rmse_ci95 = {0.008, 0.012};
    bar.bias_ci95 = {-0.002, 0};
    result.error_bar = bar;

    EnvironmentMap map;
    map.width = 64;
    map.height = 32;
    map.source_format = "hdr";
    map.repairs.negative_pixels = 3;
    map.repairs.energy_removed = 0.5;
    result.environment = map;
    IrradianceMaps maps;
    maps.face_size = 4;
    maps.exponent = 64;
    maps.diffuse = counted_cube(4, 0);
    for (int m = 0; m < 3; ++m) maps.specular.push_back(counted_cube(4, 1000.f * float(m + 1)));
    maps.specular_statistics.resize(3);
    maps.environment_sh_bands = 2;
    maps.environment_sh = {{1, 2, 3}, {0.1, 0.2, 0.3}, {1e-20, 0, -5}, {7, 8, 9}};
    result.irradiance = maps;
    result.warnings = {"a warning with \"quotes\""};
    return result;
}

}  // namespace hairbake::test_support
