// The real program, run as a person would.
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/run_program.h"
#include "tests/support/temporary_folder.h"

namespace hairbake::test_support {

/// Runs hairbake with the arguments; standard error is part of the output only with "2>&1" among them.
inline Finished hairbake(const std::string& arguments) {
    return run_program(shell_word(HAIRBAKE_PROGRAM) + " " + arguments);
}

inline nlohmann::json json_of(const std::filesystem::path& file) {
    std::ifstream stream(file);
    return nlohmann::json::parse(stream);
}

inline bool contains(const std::string& text, const std::string& piece) {
    return text.find(piece) != std::string::npos;
}

/// A small groom and skies, written by `hairbake sample`, and a place for results.
class Workshop {
public:
    Workshop() { hairbake("sample " + path("samples") + " --vertices 3000 --style curly --map-width 64"); }

    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    std::string hair() const { return " --hair " + path("samples/groom.hair"); }
    std::string env() const { return " --env " + path("samples/sky.hdr"); }
    std::string out(const std::string& name = "out") const { return " --out " + path(name); }
    /// A bake of hair and sky that takes well under a second.
    std::string quick_bake() const {
        return "bake" + hair() + env() + out() +
               " --directions 16 --voxels 32 --face-size 4 --specular-maps 3 --set transmittance.reference_vertices=10";
    }
    /// Names in the workshop, hidden ones too.
    std::vector<std::string> names() const {
        std::vector<std::string> found;
        for (const auto& entry : std::filesystem::directory_iterator(folder_ / ""))
            found.push_back(entry.path().filename());
        std::sort(found.begin(), found.end());
        return found;
    }

private:
    TemporaryFolder folder_;
};

}  // namespace hairbake::test_support
