// Writing and reading picture files in tests.
#pragma once

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
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

using Change = std::function<void(OIIO::ImageSpec&)>;

/// An EXR file of floats whose header `change` has changed.
inline void write_exr(const std::filesystem::path& file, int w, int h, const std::vector<Vec3f>& pixels,
                      const Change& change) {
    OIIO::ImageSpec spec(w, h, 3, OIIO::TypeDesc::FLOAT);
    change(spec);
    const auto output = OIIO::ImageOutput::create(file.string());
    ASSERT_TRUE(output && output->open(file.string(), spec)) << OIIO::geterror();
    ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, pixels.data())) << output->geterror();
    ASSERT_TRUE(output->close());
}

}  // namespace hairbake::picture_files
