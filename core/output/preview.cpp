#include "core/output/preview.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/base/luminance.h"
#include "core/output/canvas.h"
#include "core/output/hair_picture.h"
#include "core/output/latlong_picture.h"
#include "core/output/picture_encoding.h"
#include "core/output/tone.h"
#include "core/output/versions.h"

namespace hairbake {
namespace {

constexpr Color background{22, 24, 28}, panel{32, 35, 41}, line{62, 67, 76}, dim{150, 157, 168}, bright{232, 235, 240},
    accent{236, 167, 84};
constexpr int margin = 32, sheet_width = 1600, inner_width = sheet_width - 2 * margin;
constexpr int header_height = 104, transmittance_height = 520, diffuse_height = 364;
constexpr int columns = 6, gap = 16, tile_width = (inner_width - (columns - 1) * gap) / columns;
constexpr int tile_height = tile_width / 2, tile_step = tile_height + 40;
constexpr std::size_t most_tiles = 36;

template <class... Values>
std::string format(const char* pattern, Values... values) {
    char buffer[256];
    std::snprintf(buffer, sizeof buffer, pattern, values...);
    return buffer;
}

/// The canvas, and whether all labels could be drawn.
struct Sheet {
    Canvas canvas;
    bool labels_drawn = true;

    void text(int x, int y, const std::string& words, int size, Color color, Canvas::Align align = Canvas::Align::left,
              bool bold = false) {
        labels_drawn &= canvas.text(x, y, words, size, color, align, bold);
    }
};

// ---- transmittance -------------------------------------------------------------------------------------------------

void draw_groom(Sheet& sheet, const HairModel& hair, std::span<const float> average, View view, int left, int top,
                int size) {
    sheet.canvas.fill(left, top, size, size, panel);
    const HairPicture picture = draw_hair(hair, average, view, 2 * size);
    const Color empty = panel;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            std::array<int, 3> sum{};
            for (const int i : {0, 1, 2, 3}) {
                const std::size_t pixel = static_cast<std::size_t>(2 * y + i / 2) * picture.size + 2 * x + i % 2;
                const float a = picture.value[pixel];
                const auto grey = static_cast<int>(std::lround(20 + 235 * std::pow(std::clamp(a, 0.f, 1.f), 0.75f)));
                for (int c = 0; c < 3; ++c) sum[c] += a < 0 ? empty[c] : grey - 14 * c;
            }
            sheet.canvas.set(left + x, top + y,
                             {static_cast<std::uint8_t>(sum[0] / 4), static_cast<std::uint8_t>(std::max(0, sum[1] / 4)),
                              static_cast<std::uint8_t>(std::max(0, sum[2] / 4))});
        }
    sheet.text(left + 10, top + size - 12, view == View::front ? "A seen from +Z" : "A seen from +X", 14, dim);
}

void draw_axis(Sheet& sheet, int left, int bottom, int width) {
    sheet.canvas.fill(left, bottom, width, 1, line);
    for (int tick = 0; tick <= 4; ++tick) {
        const int x = left + tick * (width - 1) / 4;
        sheet.canvas.fill(x, bottom, 1, 6, line);
        sheet.text(x, bottom + 22, format("%.2f", tick / 4.0), 13, dim, Canvas::Align::center);
    }
    sheet.text(left + width / 2, bottom + 44, "A, average transmittance of a vertex", 13, dim, Canvas::Align::center);
}

void draw_histogram(Sheet& sheet, const std::vector<float>& average, int left, int top, int width, int height) {
    constexpr int bars = 64;
    std::vector<std::uint64_t> count(bars);
    double sum = 0;
    for (const float a : average) {
        ++count[static_cast<std::size_t>(std::clamp(static_cast<int>(a * bars), 0, bars - 1))];
        sum += a;
    }
    const auto most = std::max<std::uint64_t>(1, *std::max_element(count.begin(), count.end()));
    for (int i = 0; i < bars; ++i) {
        const int from = left + i * width / bars, to = left + (i + 1) * width / bars;
        const auto bar = static_cast<int>(std::lround(double(count[i]) / double(most) * height));
        const auto grey = static_cast<std::uint8_t>(70 + 150 * i / bars);
        sheet.canvas.fill(from, top + height - bar, to - from - 1, bar, {grey, grey, grey});
    }
    draw_axis(sheet, left, top + height, width);
    if (average.empty()) return;
    const double mean = sum / static_cast<double>(average.size());
    const int x = left + static_cast<int>(mean * (width - 1));
    sheet.canvas.fill(x, top - 4, 2, height + 4, accent);
    sheet.text(x + 8, top + 8, format("mean %.4f", mean), 14, accent);
}

std::string error_text(const TransmittanceFacts& facts) {
    if (!facts.error_bar) return "no error bar (reference_vertices 0)";
    const ErrorFigures& bar = facts.error_bar->outside;
    if (bar.vertices == 0) return "no error bar (no vertex lies outside other strands)";
    return format("against %d traced vertices: RMSE %.4f (%.4f to %.4f), bias %+.4f", int(bar.vertices), bar.rmse,
                  bar.rmse_ci95[0], bar.rmse_ci95[1], bar.bias);
}

void draw_transmittance(Sheet& sheet, const BakeResult& result, const StagePart& part, int top) {
    constexpr int size = 440;
    const std::vector<float>& average = find_array(part.arrays, average_transmittance_kind())->values;
    int left = margin;
    if (result.hair && result.hair->vertex_count() > 0) {
        draw_groom(sheet, *result.hair, average, View::front, left, top, size);
        draw_groom(sheet, *result.hair, average, View::side, left + size + gap, top, size);
        left += 2 * (size + gap) + 16;
    }
    sheet.text(left, top + 22, "transmittance", 22, bright, Canvas::Align::left, true);
    if (const auto* facts = std::get_if<TransmittanceFacts>(&part.facts)) {
        const bool traced = result.request.transmittance.method == TransmittanceMethod::trace;
        const std::string how = traced ? "traced" : format("voxel size %.4g", facts->voxel_size);
        sheet.text(left, top + 50,
                   format("%zu vertices, %d directions, %s", average.size(), facts->directions, how.c_str()), 15, dim);
        sheet.text(left, top + 74, error_text(*facts), 13, dim);
    }
    draw_histogram(sheet, average, left, top + 110, sheet_width - margin - left, size - 110 - 50);
}

// ---- irradiance ----------------------------------------------------------------------------------------------------

void draw_map(Sheet& sheet, const CubeTexels& cube, int face_size, double stops, int left, int top, int width) {
    const Picture picture = to_latlong(cube, face_size, width);
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x)
            sheet.canvas.set(left + x, top + y, tone(picture.pixels[static_cast<std::size_t>(y) * width + x], stops));
}

double exposure_of(std::span<const CubeTexels> maps) {
    std::vector<float> values;
    for (const CubeTexels& map : maps)
        for (const Vec3f& texel : map) values.push_back(luminance(texel));
    return exposure_for(std::move(values));
}

/// The six faces unfolded around +Z as they are stored, each with its name.
void draw_net(Sheet& sheet, const CubeTexels& cube, int face_size, double stops, int left, int top, int size) {
    constexpr std::array<std::array<int, 2>, cube_faces> place{{{2, 1}, {0, 1}, {1, 0}, {1, 2}, {1, 1}, {3, 1}}};
    for (int face = 0; face < cube_faces; ++face) {
        const int x0 = left + place[face][0] * size, y0 = top + place[face][1] * size;
        for (int y = 0; y < size - 2; ++y)
            for (int x = 0; x < size - 2; ++x) {
                const Vec3d direction =
                    cube_direction({face, 2 * (x + 0.5) / (size - 2) - 1, 2 * (y + 0.5) / (size - 2) - 1});
                sheet.canvas.set(x0 + x, y0 + y, tone(Vec3f(sample_cube(cube, face_size, direction)), stops));
            }
        sheet.text(x0 + 8, y0 + 20, std::string(cube_face_name(face)), 13, background);
    }
}

/// The lines beside the map of a lobe that has one map.
std::vector<std::string> map_facts(const BakeResult& result, const StagePart& part, const MapLobe& lobe, double stops) {
    const int n = part.maps->face_size;
    std::vector<std::string> lines{format("shown at %+.2f stops", stops),
                                   "lat-long: centre +X, right of it +Z, top +Y"};
    if (!lobe.statistics.empty()) {
        const Vec3d& mean = lobe.statistics[0].mean;
        lines.push_back(format("mean irradiance %.4g %.4g %.4g", mean.x, mean.y, mean.z));
    }
    lines.push_back(format("cube faces of %d x %d texels", n, n));
    if (const auto* facts = std::get_if<IrradianceFacts>(&part.facts))
        lines.push_back(facts->from_sh ? format("SH with %d bands diffuse, %d specular", facts->sh_bands_diffuse,
                                                facts->sh_bands_specular)
                                       : "exact sum over the environment's pixels");
    if (result.inputs.environment) {
        const EnvironmentMap& map = *result.inputs.environment;
        lines.push_back(map.shape == EnvironmentShape::cube
                            ? format("environment %d x %d x 6, %s", map.width, map.width, map.source_format.c_str())
                            : format("environment %d x %d, %s", map.width, map.height, map.source_format.c_str()));
    }
    return lines;
}

/// A lobe of one map: as lat-long, as the net of its faces, and in words.
void draw_single_map(Sheet& sheet, const BakeResult& result, const StagePart& part, const MapLobe& lobe, int top) {
    const int n = part.maps->face_size;
    const double stops = exposure_of(lobe.cubes);
    constexpr int width = 640, net_face = 108, net_left = margin + width + 24;
    draw_map(sheet, lobe.cubes[0], n, stops, margin, top, width);
    draw_net(sheet, lobe.cubes[0], n, stops, net_left, top, net_face);

    constexpr int left = net_left + 4 * net_face + 24;
    sheet.text(left, top + 22, lobe.name, 22, bright, Canvas::Align::left, true);
    int y = top + 54;
    for (const std::string& words : map_facts(result, part, lobe, stops)) {
        sheet.text(left, y, words, 15, dim);
        y += 26;
    }
}

/// Indices of the maps that are shown: all, or `most_tiles` of them evenly spread with both ends.
std::vector<std::size_t> shown_maps(std::size_t count) {
    const std::size_t tiles = std::min(count, most_tiles);
    std::vector<std::size_t> shown;
    for (std::size_t i = 0; i < tiles; ++i) shown.push_back(tiles > 1 ? i * (count - 1) / (tiles - 1) : 0);
    return shown;
}

/// A lobe with slices: tiles of its maps.
void draw_slices(Sheet& sheet, const MapSet& maps, const MapLobe& lobe, int top) {
    const double stops = exposure_of(lobe.cubes);
    const std::vector<std::size_t> shown = shown_maps(lobe.cubes.size());
    std::string parameters;
    for (const auto& [name, value] : maps.parameters) parameters += format("%s %g, ", name.c_str(), value);
    sheet.text(margin, top + 22, lobe.name, 22, bright, Canvas::Align::left, true);
    sheet.text(margin + 124, top + 22,
               format("%zu of %zu maps, %sall shown at %+.2f stops", shown.size(), lobe.cubes.size(),
                      parameters.c_str(), stops),
               15, dim);
    for (std::size_t i = 0; i < shown.size(); ++i) {
        const int left = margin + static_cast<int>(i % columns) * (tile_width + gap);
        const int tile_top = top + 44 + static_cast<int>(i / columns) * tile_step;
        draw_map(sheet, lobe.cubes[shown[i]], maps.face_size, stops, left, tile_top, tile_width);
        sheet.text(left, tile_top + tile_height + 18,
                   format("%s m=%02zu   theta' = %.4g deg", lobe.name.c_str(), shown[i],
                          lobe.theta_prime_deg[shown[i] / lobe.orders]),
                   13, dim);
    }
}

int lobe_height(const MapLobe& lobe) {
    if (!lobe.has_slices()) return diffuse_height;
    const auto tiles = static_cast<int>(shown_maps(lobe.cubes.size()).size());
    return 44 + (tiles + columns - 1) / columns * tile_step;
}

// ---- the sheet -----------------------------------------------------------------------------------------------------

bool has_transmittance(const StagePart& part) { return find_array(part.arrays, average_transmittance_kind()); }

int part_height(const StagePart& part) {
    int height = has_transmittance(part) ? transmittance_height - 40 : 0;
    if (part.maps)
        for (const MapLobe& lobe : part.maps->lobes) height += lobe_height(lobe);
    return height;
}

void draw_part(Sheet& sheet, const BakeResult& result, const StagePart& part, int top) {
    if (has_transmittance(part)) {
        draw_transmittance(sheet, result, part, top);
        top += transmittance_height - 40;
    }
    if (!part.maps) return;
    for (const MapLobe& lobe : part.maps->lobes) {
        if (lobe.has_slices())
            draw_slices(sheet, *part.maps, lobe, top);
        else
            draw_single_map(sheet, result, part, lobe, top);
        top += lobe_height(lobe);
    }
}

}  // namespace

WrittenFile write_preview(const BakeResult& result, const std::filesystem::path& folder,
                          std::vector<std::string>& warnings) {
    int height = header_height + margin - 12;
    for (const StagePart& part : result.parts) height += part_height(part);
    Sheet sheet{Canvas(sheet_width, height, background)};
    sheet.text(margin, 52, "hairbake", 30, bright, Canvas::Align::left, true);
    sheet.text(margin + 176, 52, version() + "   bake " + result.id.substr(0, 12), 18, dim);
    sheet.canvas.fill(margin, 76, inner_width, 1, line);
    int top = header_height;
    for (const StagePart& part : result.parts) {
        draw_part(sheet, result, part, top);
        top += part_height(part);
    }
    if (!sheet.labels_drawn)
        warnings.push_back("preview.png has no labels: the font DejaVu Sans (package fonts-dejavu-core) is missing");

    FileSink sink(folder / "preview.png");
    sink.write(encode_png(sheet.canvas.rgb(), sheet.canvas.width(), sheet.canvas.height(), {}));
    WrittenFile written = sink.finish();
    written.shape = {static_cast<std::size_t>(sheet.canvas.height()), static_cast<std::size_t>(sheet.canvas.width()),
                     3};
    written.content = "contact sheet";
    return written;
}

}  // namespace hairbake
