// Recognises image files by their first bytes.
#pragma once

#include <string_view>

namespace hairbake {

/// Bytes of a file's start that kind_of_image needs at most; an Ultra-HDR JPEG tells of its gain map within them.
inline constexpr int image_start_bytes = 65536;

/// What a file is. One of the two texts is not empty.
struct ImageKind {
    std::string_view reader;   ///< OpenImageIO's name of a kind that is read: hdr, openexr, tiff, pnm, png
    std::string_view refusal;  ///< of a kind that is not read: "a JPEG picture ...: ..."
};

/// The kind by the file's first bytes, whatever its name says. Unknown bytes are a refusal too.
ImageKind kind_of_image(std::string_view start);

}  // namespace hairbake
