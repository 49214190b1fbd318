// Finds the files of an environment: one picture, or six with a cube's faces.
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

/// The files that `path` names: a file, a folder with six faces, or a pattern. The file name of a pattern contains
/// {face} once, such as sky_{face}.hdr.
/// The faces +X -X +Y -Y +Z -Z are named px nx py ny pz nz, or posx negx posy negy posz negz, or right left top bottom
/// front back, in upper or lower case. In a pattern such a name replaces {face}. In a folder it is the last word of the
/// file's name: px.hdr, sky_px.hdr, sky-px.hdr, sky.px.hdr, "sky px.hdr". A folder may hold one complete set of six
/// with the same beginning, ending and kind of names. Other files are ignored, and so are pictures of other kinds than
/// HDR, EXR, TIFF, PFM and PNG.
/// Throws Error(bad_input) where nothing is there, faces are missing, or a face has several files. The message names
/// the expected and the found files.
EnvironmentFiles find_environment_files(const std::filesystem::path& path);

/// SHA-256 of the environment's bytes: of the file, or of the six files' digests in the order of the faces.
/// Throws Error(bad_input) when a file cannot be read.
std::string digest_of_environment(const std::filesystem::path& path);

}  // namespace hairbake
