#include "server/worker/trial.h"

#include <span>
#include <sstream>

#include "core/bake.h"
#include "core/hair/hair_format_writer.h"
#include "core/output/file_sink.h"
#include "core/output/picture_encoding.h"
#include "core/request/stages.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

/// 8 x 8 upright strands of 4 points in a box of edge 1.
HairModel groom() {
    constexpr int across = 8, points = 4;
    HairModel model;
    model.default_thickness = 0.01f;
    model.strand_begin.push_back(0);
    for (int s = 0; s < across * across; ++s) {
        for (int p = 0; p < points; ++p)
            model.positions.push_back({float(s % across) / across, float(p) / points, float(s / across) / across});
        model.strand_begin.push_back(static_cast<std::uint32_t>(model.positions.size()));
    }
    return model;
}

void write_groom(const fs::path& file) {
    const HairModel model = groom();
    std::ostringstream stream;
    write_hair(model, stream, make_hair_file_extras(model, "trial"));
    FileSink sink(file);
    sink.write(stream.str());
    sink.finish();
}

void write_sky(const fs::path& file) {
    constexpr int width = 16, height = 8;
    FileSink sink(file);
    sink.write(encode_exr(std::vector<Vec3f>(width * height, {1, 1, 1}), width, height, {}));
    sink.finish();
}

}  // namespace

void run_trial(const fs::path& folder, int threads, BakeProgress& progress) {
    BakeRequest request;
    request.hair = (folder / "groom.hair").string();
    request.environment = (folder / "sky.exr").string();
    write_groom(*request.hair);
    write_sky(*request.environment);
    request.transmittance.directions = 16;
    request.transmittance.voxels = 32;
    request.transmittance.reference_vertices = 8;
    request.irradiance.face_size = 4;
    request.irradiance.specular_maps = 2;
    request.outputs = {"npy"};
    BakeResult result = bake(request, threads, progress);
    write_result(result, folder / "result", progress);
}

}  // namespace hairbake
