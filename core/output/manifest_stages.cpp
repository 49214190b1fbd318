#include "core/output/manifest_stages.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>

namespace hairbake {
namespace {

using Json = nlohmann::ordered_json;

template <class T>
Json triple(const Vec3<T>& v) {
    return {v.x, v.y, v.z};
}

// ---- transmittance -------------------------------------------------------------------------------------------------

/// Means over the receiver's points; null when it has none.
Json receiver_means(const std::vector<float>& receiver) {
    double plain = 0, cosine = 0;
    for (std::size_t i = 0; i + 1 < receiver.size(); i += 2) {
        plain += receiver[i];
        cosine += receiver[i + 1];
    }
    const std::size_t positions = receiver.size() / 2;
    const auto points = static_cast<double>(positions);
    return {{"positions", positions},
            {"mean", points > 0 ? Json(plain / points) : Json()},
            {"cosine_mean", points > 0 ? Json(cosine / points) : Json()}};
}

/// Null without a vertex to measure at: an unknown error is not an error of 0.
Json error_figures(const ErrorFigures& figures) {
    const auto measured = [&](const auto& value) { return figures.vertices > 0 ? Json(value) : Json(); };
    return {{"rmse", measured(figures.rmse)},
            {"bias", measured(figures.bias)},
            {"ci95", {{"rmse", measured(figures.rmse_ci95)}, {"bias", measured(figures.bias_ci95)}}},
            {"noise", measured(figures.noise)},
            {"vertices", figures.vertices}};
}

/// The figures of the vertices outside other strands stand on top.
Json error_bar(const ErrorBar& bar) {
    Json block = error_figures(bar.outside);
    block["clear"] = error_figures(bar.clear);
    block["inside_strand"] = bar.inside_strand;
    block["directions"] = bar.directions;
    return block;
}

Json describe(const std::monostate&, const StagePart&, const BakeRequest&) { return Json::object(); }

std::string_view reason_text(VoxelReason reason) {
    switch (reason) {
        case VoxelReason::asked:
            return "as the request asks";
        case VoxelReason::spacing:
            return "auto: 0.8 times the distance between strands";
        case VoxelReason::resolution:
            return "auto: 25.6 times the square root of directions on the longest axis";
        case VoxelReason::width:
            return "twice the 95th percentile of the widths";
    }
    return {};
}

Json describe(const TransmittanceFacts& facts, const StagePart& part, const BakeRequest& request) {
    const std::vector<float>& average = find_array(part.arrays, average_transmittance_kind())->values;
    double sum = 0;
    for (const float a : average) sum += a;
    const bool any = !average.empty();
    Json block{{"vertices", average.size()},
               {"method", name_in(transmittance_method_names, facts.method)},
               {"method_reason", facts.method_reason},
               {"directions", facts.directions},
               {"voxel_size", facts.voxel_size},
               {"voxel_reason", facts.voxel_size > 0 ? Json(reason_text(facts.voxel_reason)) : Json()},
               {"occupied_voxels", facts.occupied_voxels},
               {"mean", any ? Json(sum / static_cast<double>(average.size())) : Json()},
               {"minimum", any ? Json(*std::min_element(average.begin(), average.end())) : Json()},
               {"maximum", any ? Json(*std::max_element(average.begin(), average.end())) : Json()}};
    block["sh_bands"] = request.transmittance.sh_bands;
    block["bent_cone"] = request.transmittance.bent_cone;
    if (const VertexArray* receiver = find_array(part.arrays, receiver_kind()))
        block["receiver"] = receiver_means(receiver->values);
    return {{"transmittance", block}, {"error_bar", facts.error_bar ? error_bar(*facts.error_bar) : Json()}};
}

// ---- irradiance ----------------------------------------------------------------------------------------------------

Json map_statistics(const MapStatistics& statistics) {
    return {{"mean", triple(statistics.mean)},
            {"minimum", triple(statistics.minimum)},
            {"maximum", triple(statistics.maximum)},
            {"clamped_negative_mass", statistics.clamped_negative_mass}};
}

/// An object for a lobe of one map, a list of objects for one with slices.
Json describe_lobe(const MapLobe& lobe) {
    Json list = Json::array();
    for (std::size_t i = 0; i < lobe.cubes.size(); ++i) {
        Json map = Json::object();
        if (lobe.has_slices()) map["theta_prime_deg"] = lobe.theta_prime_deg[i / lobe.orders];
        if (i < lobe.statistics.size()) map.update(map_statistics(lobe.statistics[i]));
        list.push_back(map);
    }
    return lobe.has_slices() ? list : list.at(0);
}

Json describe(const IrradianceFacts& facts, const StagePart& part, const BakeRequest&) {
    Json block{{"face_size", part.maps->face_size}};
    for (const auto& [name, value] : part.maps->parameters) block[name] = value;
    for (const MapLobe& lobe : part.maps->lobes) block[lobe.name] = describe_lobe(lobe);
    block["interpolation_bound"] = triple(facts.interpolation_bound);
    block["interpolation_bound_relative"] = facts.interpolation_bound_relative;
    block["environment_sh_bands"] = facts.environment_sh_bands;
    if (facts.from_sh) {
        block["sh_bands"] = {{"diffuse", facts.sh_bands_diffuse}, {"specular", facts.sh_bands_specular}};
        block["predicted_error"] = {{"diffuse", facts.predicted_error_diffuse},
                                    {"specular", facts.predicted_error_specular}};
    }
    return {{"irradiance", block}};
}

// ---- effective transmittance ---------------------------------------------------------------------------------------

/// "c0 + c1 * x + c2 * (2.0 * x * x - 1.0)": the series in x = cos theta'.
std::string cosine_series(int cosines, int first) {
    constexpr std::string_view terms[] = {"", " * x", " * (2.0 * x * x - 1.0)", " * (4.0 * x * x - 3.0) * x",
                                          " * (8.0 * x * x * (x * x - 1.0) + 1.0)"};
    std::string text;
    for (int j = 0; j < cosines; ++j)
        text += (j > 0 ? " + " : "") + ("e" + std::to_string(first + j)) + std::string(terms[j]);
    return text;
}

Json run_time(const EffectiveFacts& facts) {
    const int diffuse = facts.diffuse_components;
    const std::string ad = diffuse == 3 ? "vec3(e0, e1, e2)" : "e0";
    const std::string formula = "float x = clamp(dot(tangent, to_eye), -1.0, 1.0); vec3 lo = Kd * " + ad +
                                " * D + Ks * clamp(" + cosine_series(facts.cosines, diffuse) + ", 0.0, 1.0) * S;";
    return {
        {"words",
         "e0, e1 ... are the array's numbers of a vertex, interpolated. D and S are the look-ups of the maps diffuse "
         "and specular. The first numbers (Ad) multiply Kd D. The others are the terms cos(j theta') of a series in "
         "the angle theta' between tangent and eye; its value, clamped to 0 to 1, multiplies Ks S."},
        {"glsl", formula}};
}

/// Null with fewer than three neighbourhoods.
Json neighborhood_figures(const NeighborhoodFigures& figures, std::uint32_t neighborhoods) {
    const auto measured = [&](const auto& value) { return neighborhoods > 2 ? Json(value) : Json(); };
    return {{"bias", measured(figures.bias)},
            {"slope", measured(figures.slope)},
            {"rmse", measured(figures.rmse)},
            {"ci95", {{"bias", measured(figures.bias_ci95)}, {"slope", measured(figures.slope_ci95)}}}};
}

/// Errors are shares of the mean light.
Json picture_error(const NeighborhoodError& error) {
    Json block = neighborhood_figures(error.effective, error.neighborhoods);
    block["average_alone"] = neighborhood_figures(error.average, error.neighborhoods);
    block["neighborhoods"] = error.neighborhoods;
    block["vertices"] = error.vertices;
    return block;
}

Json describe(const EffectiveFacts& facts, const StagePart&, const BakeRequest&) {
    Json lights = Json::array();
    for (const ClusteredLight& light : facts.lights)
        lights.push_back({{"direction", triple(light.direction)}, {"flux", triple(light.flux)}});
    return {{"effective_transmittance",
             {{"method", name_in(transmittance_method_names, facts.method)},
              {"method_reason", facts.method_reason},
              {"diffuse", facts.diffuse_components == 3 ? "rgb" : "luminance"},
              {"cosines", facts.cosines},
              {"tangent_face_size", facts.face_size},
              {"error_bar", facts.error ? picture_error(*facts.error) : Json()},
              {"run_time", run_time(facts)},
              {"lights", std::move(lights)}}}};
}

}  // namespace

Json describe_part(const StagePart& part, const BakeRequest& request) {
    return std::visit([&](const auto& facts) { return describe(facts, part, request); }, part.facts);
}

}  // namespace hairbake
