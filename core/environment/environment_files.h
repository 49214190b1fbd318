// Which files an environment consists of: one picture, or six with a cube's faces.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace hairbake {

/// One file, or six in the order of cube_map.h: +X -X +Y -Y +Z -Z.
struct EnvironmentFiles {
    std::vector<std::filesystem::path> files;

    bool faces() const { return files.size() > 1; }
};

/// What `path` names: a file, a folder with six faces, or a pattern whose file name contains {face} once, such as
/// sky_{face}.hdr. A face is told by its name, in upper or lower case: px nx py ny pz nz, or posx negx posy negy posz
/// negz, or right left top bottom front back, for +X -X +Y -Y +Z -Z. In a pattern the name stands for {face}; in a
/// folder it is the last word of the file's name (px.hdr, sky_px.hdr, sky-px.hdr, sky.px.hdr, "sky px.hdr"), other
/// files (and pictures of other kinds than HDR, EXR, TIFF, PFM and PNG) are passed over, and just one complete set of
/// six with the same beginning, ending and kind of names may be there. Throws Error(bad_input): nothing there, faces
/// missing, or several files for a face, with what was looked for and what was found.
EnvironmentFiles find_environment_files(const std::filesystem::path& path);

/// SHA-256 that names the environment's bytes: of the file, or over the six files' digests in the order of the faces.
/// Throws Error(bad_input) when a file cannot be read.
std::string digest_of_environment(const std::filesystem::path& path);

}  // namespace hairbake
