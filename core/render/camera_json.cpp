#include "core/render/camera_json.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <system_error>

#include "core/base/error.h"
#include "core/base/json_reason.h"

namespace hairbake {
namespace {

using Json = nlohmann::ordered_json;

Json read_object(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw Error(ErrorKind::bad_input, file.string() + ": " + std::generic_category().message(errno));
    std::string text(65536, '\0');
    stream.read(text.data(), static_cast<std::streamsize>(text.size()));
    if (stream.bad()) throw Error(ErrorKind::bad_input, file.string() + ": " + std::generic_category().message(errno));
    text.resize(static_cast<std::size_t>(stream.gcount()));
    Json object = Json::parse(text, nullptr, false);
    if (!object.is_object()) throw Error(ErrorKind::bad_input, file.string() + " is no JSON object of at most 64 KiB");
    return object;
}

void check_fields(const Json& object, std::initializer_list<std::string_view> allowed, const std::string& file) {
    for (const auto& [name, value] : object.items())
        if (std::find(allowed.begin(), allowed.end(), name) == allowed.end()) {
            std::string names;
            for (const std::string_view field : allowed) names += (names.empty() ? "" : ", ") + std::string(field);
            throw Error(ErrorKind::bad_input, file + ": unknown field \"" + name + "\"; allowed are " + names);
        }
}

Vec3d vector_of(const Json& value) {
    const auto v = value.get<std::array<double, 3>>();
    return {v[0], v[1], v[2]};
}

}  // namespace

Camera read_camera(const std::filesystem::path& file, const Vec3f& bounds_min, const Vec3f& bounds_max, double aspect) {
    const Json object = read_object(file);
    try {
        if (object.contains("eye")) {
            check_fields(object, {"eye", "target", "up", "fov_deg"}, file.string());
            const Vec3d up = object.contains("up") ? vector_of(object["up"]) : Vec3d{0, 1, 0};
            return look_at(vector_of(object.at("eye")), vector_of(object.at("target")), up,
                           object.value("fov_deg", 30.0));
        }
        check_fields(object, {"target", "distance", "azimuth_deg", "elevation_deg", "fov_deg"}, file.string());
        OrbitSettings orbit;
        if (object.contains("target")) orbit.target = vector_of(object["target"]);
        if (object.contains("distance")) orbit.distance = object["distance"].get<double>();
        orbit.azimuth_deg = object.value("azimuth_deg", orbit.azimuth_deg);
        orbit.elevation_deg = object.value("elevation_deg", orbit.elevation_deg);
        orbit.fov_deg = object.value("fov_deg", orbit.fov_deg);
        return orbit_camera(orbit, bounds_min, bounds_max, aspect);
    } catch (const Json::exception& error) {
        throw Error(ErrorKind::bad_input, file.string() + ": " + json_reason(error));
    }
}

}  // namespace hairbake
