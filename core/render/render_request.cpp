#include "core/render/render_request.h"

#include "core/base/error.h"
#include "core/base/short_number.h"

namespace hairbake {
namespace {

void expect(double value, double low, double high, const char* field) {
    if (!(value >= low && value <= high))
        throw Error(ErrorKind::usage,
                    std::string(field) + " is " + short_number(value) + "; allowed is " + short_number(low) + " to " +
                        short_number(high),
                    field);
}

}  // namespace

void validate(const RenderRequest& request) {
    expect(request.frame.width, 1, 16384, "width");
    expect(request.frame.height, 1, 16384, "height");
    expect(request.frame.samples, 1, 65536, "samples");
    expect(request.light_samples, 1, 65536, "light_samples");
    expect(request.look.albedo, 0, 1, "albedo");
    expect(request.look.specular, 0, 10, "specular");
    for (const double channel : request.look.color) expect(channel, 0, 1, "color");
    for (const double channel : request.look.mesh_albedo) expect(channel, 0, 1, "mesh_albedo");
}

bool shows_light(const RenderRequest& request) {
    return request.mode != ShadingMode::baked || is_light(request.frame.channel);
}

bool needs_environment(const RenderRequest& request) {
    const bool around = request.frame.channel == Channel::beauty && (request.background || request.mesh);
    return !uses_maps(request.mode) || around;
}

}  // namespace hairbake
