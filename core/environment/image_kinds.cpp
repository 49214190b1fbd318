#include "core/environment/image_kinds.h"

namespace hairbake {
namespace {

using namespace std::string_view_literals;

struct Magic {
    std::size_t offset;
    std::string_view bytes;
    ImageKind kind;
};

constexpr Magic table[] = {
    {0, "#?"sv, {"hdr", {}}},
    {0, "\x76\x2f\x31\x01"sv, {"openexr", {}}},
    {0, "II*\0"sv, {"tiff", {}}},
    {0, "MM\0*"sv, {"tiff", {}}},
    {0, "II+\0"sv, {"tiff", {}}},
    {0, "MM\0+"sv, {"tiff", {}}},
    {0, "PF"sv, {"pnm", {}}},
    {0, "Pf"sv, {"pnm", {}}},
    {0, "\x89PNG"sv, {"png", {}}},
    {4, "ftypavif"sv, {{}, "an AVIF picture, which is not read"}},
    {4, "ftyphei"sv, {{}, "a HEIF picture, which is not read"}},
    {0, "\xff\x0a"sv, {{}, "a JPEG XL picture, which is not read"}},
    {0, "\0\0\0\x0cJXL "sv, {{}, "a JPEG XL picture, which is not read"}},
    {0, "RIFF"sv, {{}, "a WebP picture, which is not read and whose range is low"}},
    {0, "GIF8"sv, {{}, "a GIF picture, which is not read and whose range is low"}},
    {0, "BM"sv, {{}, "a BMP picture, which is not read and whose range is low"}},
    {0, "8BPS"sv, {{}, "a Photoshop document, which is not read"}},
    {0, "DDS "sv, {{}, "a DDS texture, which is written but not read"}},
    {0, "\xabKTX"sv, {{}, "a KTX texture, which is written but not read"}},
    {0, "\x13\xab\xa1\x5c"sv, {{}, "an ASTC texture, which is not read"}},
    {0, "P3"sv, {{}, "an integer picture of the PNM family; of these PFM is read"}},
    {0, "P6"sv, {{}, "an integer picture of the PNM family; of these PFM is read"}},
};
constexpr std::string_view jpeg = "\xff\xd8\xff"sv;

}  // namespace

ImageKind kind_of_image(std::string_view start) {
    for (const Magic& magic : table)
        if (start.size() > magic.offset && start.substr(magic.offset).starts_with(magic.bytes)) return magic.kind;
    if (start.starts_with(jpeg)) {
        const bool has_gain_map = start.find("hdrgm:") != std::string_view::npos ||
                                  start.find("http://ns.adobe.com/hdr-gain-map/") != std::string_view::npos ||
                                  start.find("urn:iso:std:iso:ts:21496") != std::string_view::npos;
        if (has_gain_map) return {{}, "an Ultra-HDR JPEG, whose gain map is not read"};
        return {{}, "a JPEG picture, which is not read and whose range is low"};
    }
    if (start.empty()) return {{}, "an empty file"};
    return {{}, "no known image, by its first bytes"};
}

}  // namespace hairbake
