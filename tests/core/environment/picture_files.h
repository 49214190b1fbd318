// Writing and reading picture files in tests.
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "core/environment/environment_reader.h"

namespace hairbake::picture_files {

inline void save_picture(const std::filesystem::path& file, const std::string& bytes) {
    std::ofstream(file, std::ios::binary).write(bytes.data(), std::streamsize(bytes.size()));
}

inline EnvironmentMap read_picture(const std::filesystem::path& file, const EnvironmentSettings& settings = {}) {
    Progress progress;
    return read_environment(file, settings, progress);
}

/// The message of the error, empty without one.
inline std::string picture_refusal(const std::filesystem::path& file, const EnvironmentSettings& settings = {}) {
    try {
        read_picture(file, settings);
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::bad_input);
        return e.what();
    }
    return "";
}

inline bool warns(const EnvironmentMap& map, const std::string& piece) {
    for (const std::string& warning : map.warnings)
        if (warning.find(piece) != std::string::npos) return true;
    return false;
}

/// What an EXR file's header says beside the size of its data.
struct ExrHeader {
    int x = 0, y = 0;  ///< of the data window
    int full_x = 0, full_y = 0;
    std::optional<int> full_width, full_height;  ///< of the display window; without, those of the data
    bool tiled = false;
    std::string texture;  ///< "LatLong Environment", "CubeFace Environment"
    std::optional<Chromaticities> chromaticities;
};

/// An EXR file of floats, w x h pixels of data.
void write_exr(const std::filesystem::path& file, int w, int h, const std::vector<Vec3f>& pixels,
               const ExrHeader& header = {});

}  // namespace hairbake::picture_files
