#include "server/worker/thumbnail.h"

#include <algorithm>
#include <cmath>

#include "core/base/luminance.h"
#include "core/environment/environment_reader.h"
#include "core/hair/hair_file.h"
#include "core/output/canvas.h"
#include "core/output/file_sink.h"
#include "core/output/hair_picture.h"
#include "core/output/picture_encoding.h"
#include "core/output/tone.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

constexpr Color background{32, 35, 41};

void write_png(const Canvas& canvas, const fs::path& file) {
    FileSink sink(file);
    sink.write(encode_png(canvas.rgb(), canvas.width(), canvas.height(), {}));
    sink.finish();
}

/// 0.15 at a strand's root to 1 at its tip, per vertex.
std::vector<float> along_strands(const HairModel& model) {
    std::vector<float> value(model.vertex_count(), 1);
    for (std::size_t s = 0; s < model.strand_count(); ++s) {
        const std::uint32_t begin = model.strand_begin[s], end = model.strand_begin[s + 1];
        for (std::uint32_t v = begin; v < end; ++v)
            value[v] =
                0.15f + 0.85f * static_cast<float>(v - begin) / static_cast<float>(std::max(1u, end - begin - 1));
    }
    return value;
}

/// Mean of the map's pixels under one pixel of the picture.
Vec3f box_mean(const EnvironmentMap& map, int x, int y, int width, int height) {
    const auto edge = [](int i, int of, int size) { return static_cast<int>(static_cast<long long>(i) * size / of); };
    const int x0 = edge(x, width, map.width), x1 = std::max(x0 + 1, edge(x + 1, width, map.width));
    const int y0 = edge(y, height, map.height), y1 = std::max(y0 + 1, edge(y + 1, height, map.height));
    Vec3d sum;
    for (int row = y0; row < y1; ++row)
        for (int column = x0; column < x1; ++column)
            sum += Vec3d(map.pixels[static_cast<std::size_t>(row) * map.width + column]);
    return Vec3f(sum / (double(x1 - x0) * (y1 - y0)));
}

}  // namespace

void write_model_thumbnail(const fs::path& file, const fs::path& png) {
    constexpr int size = 256;
    const HairModel model = read_hair(file);
    Canvas canvas(size, size, background);
    if (model.vertex_count() > 0) {
        const HairPicture picture = draw_hair(model, along_strands(model), View::front, size);
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                const float value = picture.value[static_cast<std::size_t>(y) * size + x];
                const auto grey = static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.f, 1.f)));
                if (value >= 0) canvas.set(x, y, {grey, grey, grey});
            }
    }
    write_png(canvas, png);
}

void write_environment_thumbnail(const fs::path& file, const fs::path& png, Progress& progress) {
    constexpr int width = 256, height = 128;
    EnvironmentSettings settings;
    settings.invalid_radiance = InvalidRadiance::clamp;  // so that every map has a picture
    const EnvironmentMap map = read_environment(file, settings, progress);
    std::vector<Vec3f> pixels;
    std::vector<float> luminances;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            pixels.push_back(box_mean(map, x, y, width, height));
            luminances.push_back(luminance(pixels.back()));
        }
    const double stops = exposure_for(std::move(luminances));
    Canvas canvas(width, height, background);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) canvas.set(x, y, tone(pixels[static_cast<std::size_t>(y) * width + x], stops));
    write_png(canvas, png);
}

}  // namespace hairbake
