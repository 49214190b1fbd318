// Mesh files in memory, and the messages with which they are refused.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/mesh/mesh_file.h"

namespace hairbake::test_support {

using Triangle = std::array<std::uint32_t, 3>;

inline MeshFile mesh_of(const std::string& bytes) {
    return read_mesh_file(std::as_bytes(std::span(bytes)), "head.obj");
}

/// One warning a line.
inline std::string mesh_warnings(const std::string& bytes) {
    std::string all;
    for (const std::string& warning : mesh_of(bytes).warnings) all += warning + "\n";
    return all;
}

/// The message with which `bytes` are refused as bad input.
inline std::string mesh_refusal(const std::string& bytes) {
    try {
        mesh_of(bytes);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::bad_input);
        return error.what();
    }
    return "was read";
}

inline void expect_mesh_refusal(const std::string& bytes, const std::vector<std::string>& parts) {
    const std::string found = mesh_refusal(bytes);
    for (const std::string& part : parts) EXPECT_NE(found.find(part), std::string::npos) << part << " in: " << found;
}

}  // namespace hairbake::test_support
