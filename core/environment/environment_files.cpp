#include "core/environment/environment_files.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <optional>
#include <tuple>

#include "core/base/digest.h"
#include "core/base/error.h"
#include "core/environment/cube_map.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

using FaceNames = std::array<std::string_view, cube_faces>;
constexpr std::array<FaceNames, 3> name_sets{{{"px", "nx", "py", "ny", "pz", "nz"},
                                              {"posx", "negx", "posy", "negy", "posz", "negz"},
                                              {"right", "left", "top", "bottom", "front", "back"}}};
constexpr std::string_view placeholder = "{face}";

std::string lower(std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

struct FaceName {
    std::size_t set;
    int face;
};

std::optional<FaceName> face_of(const std::string& word) {
    for (std::size_t set = 0; set < name_sets.size(); ++set)
        for (int face = 0; face < cube_faces; ++face)
            if (lower(word) == name_sets[set][face]) return FaceName{set, face};
    return std::nullopt;
}

// Files whose names differ only in the face.
struct Set {
    std::string before, after;  // of the file's name
    std::size_t names;
    auto operator<=>(const Set&) const = default;
};

using Found = std::map<Set, std::array<std::vector<fs::path>, cube_faces>>;

std::string join(const FaceNames& names) {
    std::string text;
    for (const std::string_view name : names) text += (text.empty() ? "" : " ") + std::string(name);
    return text;
}

std::string looked_for() {
    return "looked for were six faces named " + join(name_sets[0]) + ", or " + join(name_sets[1]) + ", or " +
           join(name_sets[2]);
}

std::string describe(const Set& set) { return '"' + set.before + std::string(placeholder) + set.after + '"'; }

// The files that one set has and those that it lacks, for messages.
std::string state_of(const Set& set, const std::array<std::vector<fs::path>, cube_faces>& faces) {
    std::string there, missing;
    for (int face = 0; face < cube_faces; ++face) {
        for (const fs::path& file : faces[face]) there.append(" ").append(file.filename().string());
        if (faces[face].empty()) missing.append(" ").append(name_sets[set.names][face]);
    }
    return describe(set) + ": found" + there + (missing.empty() ? "" : "; missing" + missing);
}

// The one complete set.
EnvironmentFiles choose(const fs::path& path, const Found& found) {
    constexpr std::size_t most_told = 6;
    std::vector<const Found::value_type*> complete;
    std::string told;
    for (const auto& entry : found) {
        const auto& faces = entry.second;
        if (std::all_of(faces.begin(), faces.end(), [](const auto& files) { return files.size() == 1; }))
            complete.push_back(&entry);
    }
    std::size_t count = 0;
    for (const auto& [set, faces] : found) {
        if (++count > most_told) continue;
        told += "; " + state_of(set, faces);
    }
    if (count > most_told) told += "; and " + std::to_string(count - most_told) + " more sets of names";
    const auto fail = [&](const std::string& what) {
        throw Error(ErrorKind::bad_input, path.string() + ": " + what + "; " + looked_for() + told, "environment");
    };
    if (found.empty()) fail("there are no faces of a cube map");
    if (complete.empty()) fail("no set of six faces is complete, with one file a face");
    if (complete.size() > 1)
        fail(std::to_string(complete.size()) + " sets of six faces are there; give one as a pattern");
    EnvironmentFiles files;
    for (const auto& face : complete[0]->second) files.files.push_back(face[0]);
    return files;
}

template <class Body>
void for_each_file(const fs::path& folder, const Body& body) {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder.empty() ? fs::path(".") : folder))
        if (entry.is_regular_file()) body(entry.path());
}

EnvironmentFiles find_in_folder(const fs::path& folder) {
    Found found;
    for_each_file(folder, [&](const fs::path& file) {
        const std::string stem = file.stem().string(), ending = file.extension().string();
        constexpr std::array<std::string_view, 6> endings{".hdr", ".exr", ".tif", ".tiff", ".pfm", ".png"};
        if (std::find(endings.begin(), endings.end(), lower(ending)) == endings.end()) return;
        const std::size_t separator = stem.find_last_of("_-. ");
        const std::size_t begin = separator == std::string::npos ? 0 : separator + 1;
        if (const auto name = face_of(stem.substr(begin)))
            found[{stem.substr(0, begin), ending, name->set}][name->face].push_back(file);
    });
    return choose(folder, found);
}

EnvironmentFiles find_by_pattern(const fs::path& pattern, std::size_t begin) {
    const std::string name = pattern.filename().string();
    const std::string before = name.substr(0, begin), after = name.substr(begin + placeholder.size());
    if (after.find(placeholder) != std::string::npos)
        throw Error(ErrorKind::bad_input, pattern.string() + ": the pattern holds {face} twice; allowed is once",
                    "environment");
    if (!fs::is_directory(pattern.has_parent_path() ? pattern.parent_path() : fs::path(".")))
        throw Error(ErrorKind::bad_input, pattern.string() + ": there is no folder " + pattern.parent_path().string(),
                    "environment");
    Found found;
    for_each_file(pattern.parent_path(), [&](const fs::path& file) {
        const std::string candidate = file.filename().string();
        if (candidate.size() <= before.size() + after.size() || !candidate.starts_with(before) ||
            !candidate.ends_with(after))
            return;
        const auto face = face_of(candidate.substr(before.size(), candidate.size() - before.size() - after.size()));
        if (face) found[{before, after, face->set}][face->face].push_back(file);
    });
    return choose(pattern, found);
}

}  // namespace

EnvironmentFiles find_environment_files(const fs::path& path) try {
    if (fs::is_directory(path)) return find_in_folder(path);
    const std::size_t place = path.filename().string().find(placeholder);
    if (place != std::string::npos && !fs::exists(path)) return find_by_pattern(path, place);
    return {{path}};
} catch (const fs::filesystem_error& e) {
    throw Error(ErrorKind::bad_input, path.string() + ": " + e.code().message(), "environment");
}

std::string digest_of_environment(const fs::path& path) {
    const EnvironmentFiles found = find_environment_files(path);
    if (!found.faces()) return digest_of_file(found.files[0]);
    Digest digest;
    digest.add("hairbake cube faces\n");
    for (const fs::path& file : found.files) digest.add(digest_of_file(file) + "\n");
    return digest.hex();
}

}  // namespace hairbake
