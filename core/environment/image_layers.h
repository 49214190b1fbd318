// Chooses the layer of an image file that holds its colours. OpenEXR files have many: beauty, depth, normals, mattes.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

namespace hairbake {

/// One part of a file (OpenImageIO's subimage).
struct ImagePart {
    std::string name;                   ///< of the part; empty without
    std::vector<std::string> channels;  ///< full names, in the file's order
};

/// The layer taken.
struct ChosenLayer {
    int part = 0;
    std::array<int, 3>
        channels{};  ///< of red, green, blue; all the same for grey; of Y, RY, BY for luminance and chroma
    bool luminance_chroma = false;
    std::vector<std::string> warnings;
};

/// A layer is a part together with the channels whose names agree up to the last dot. Taken is a layer with channels R,
/// G and B (or red, green, blue) by the last word of its name: "Combined" first, then "beauty", "rgba", no name; then
/// the only colour layer; then the first one, with a warning that names the others. Layers of data (depth, normals,
/// vectors, cryptomatte, masks, occlusion ...) are never taken. Without a colour layer a single channel is grey,
/// and channels Y, RY and BY are luminance and chroma.
///   parts            at least one, each with at least one channel
///   names_are_known  the format stores channel names (OpenEXR); else three unknown channels are red, green, blue
/// Throws std::invalid_argument with the fault, without the file's name: "the file holds no colours: ...".
ChosenLayer choose_layer(std::span<const ImagePart> parts, bool names_are_known);

}  // namespace hairbake
