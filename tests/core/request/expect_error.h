// Asserts on hairbake::Error: its kind, its field and pieces of its message.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "core/base/error.h"

namespace hairbake {

inline void expect_error(const std::function<void()>& action, ErrorKind kind, const std::string& field,
                         const std::vector<std::string>& pieces = {}) {
    try {
        action();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), kind) << error.what();
        EXPECT_EQ(error.field(), field) << error.what();
        for (const std::string& piece : pieces)
            EXPECT_NE(std::string(error.what()).find(piece), std::string::npos)
                << "\"" << piece << "\" is not in \"" << error.what() << "\"";
        return;
    }
    ADD_FAILURE() << "nothing was thrown; expected an error at field " << field;
}

}  // namespace hairbake
