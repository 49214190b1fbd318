#include "core/environment/image_file.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <new>
#include <sstream>

namespace hairbake {
namespace {

constexpr int most_channels = 64;
constexpr std::int64_t pixels_per_piece = 1 << 20;
constexpr std::uintmax_t most_bytes_of_tiles = std::uintmax_t(512) << 20;  // in one row of them, decoded
// The most decoded bytes that one byte of a PNG, TIFF or EXR can represent, for any picture. Deflate reaches 1032:1 (a
// match of 258 bytes in 2 bits). Before deflate, EXR's DWA keeps 2 + 2 bytes of an 8 x 8 block of floats (256 bytes),
// and 2 bytes of a run of 128: together 64 * 1032:1. PNG's 1-bit palettes are decoded to 4 bytes: 32 * 1032:1, TIFF's
// to 3. EXR's PXR24 reaches 4/3 * 1032:1, PIZ 410:1, RLE 64:1, B44A 32:3. TIFF's Zstandard reaches 32768:1 (128 KiB in
// 4 bytes), LZMA 7100:1, LZW 1700:1 (each code one byte longer than the last), PackBits 64:1. Only TIFF's fax, JBIG,
// WebP and LERC of one colour can exceed the limit. Measured on constant maps of 16384 x 8192: at most 33,200:1 (EXR,
// DWAB).
constexpr std::uintmax_t best_ratio = 64 * 1032;

struct Source {
    std::filesystem::path file;
    std::unique_ptr<OIIO::ImageInput> input;

    [[noreturn]] void fail(const std::string& what) const {
        throw Error(ErrorKind::bad_input, file.string() + ": " + what);
    }
};

// The format by the file's first bytes. No other decoder of OpenImageIO ever reads a user's file.
std::string sniff(const Source& source) {
    std::array<unsigned char, 8> head{};
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(source.file.c_str(), "rb"), std::fclose);
    if (!stream) source.fail("cannot be opened");
    const std::size_t count = std::fread(head.data(), 1, head.size(), stream.get());
    const auto starts = [&](std::initializer_list<unsigned char> magic) {
        return count >= magic.size() && std::equal(magic.begin(), magic.end(), head.begin());
    };
    if (starts({'#', '?'})) return "hdr";
    if (starts({0x76, 0x2f, 0x31, 0x01})) return "openexr";
    if (starts({'I', 'I', 42, 0}) || starts({'M', 'M', 0, 42})) return "tiff";
    if (starts({'I', 'I', 43, 0}) || starts({'M', 'M', 0, 43})) return "tiff";
    if (starts({'P', 'F'}) || starts({'P', 'f'})) return "pnm";
    if (starts({0x89, 'P', 'N', 'G'})) return "png";
    source.fail("the file's first bytes are of no known image; allowed are HDR, EXR, TIFF, PFM and PNG");
}

void check_size(const Source& source, const OIIO::ImageSpec& spec, const std::string& format, const SizeCheck& check) {
    const std::string size = std::to_string(spec.width) + " x " + std::to_string(spec.height);
    const std::string wrong = check(spec.width, spec.height);
    if (!wrong.empty()) source.fail(wrong);
    if (spec.nchannels < 1 || spec.nchannels > most_channels)
        source.fail("the file has " + std::to_string(spec.nchannels) + " channels; allowed are 1 to 64");
    if (spec.depth > 1 || spec.deep) source.fail("the image is volumetric or deep; allowed is a flat image");
    // A run of HDR's encoding covers at most 127 bytes with 2; PFM is not compressed.
    const std::uintmax_t bytes = std::filesystem::file_size(source.file), pixels = spec.image_pixels();
    const std::uintmax_t raw = format == "hdr"   ? 4 * pixels
                               : format == "pnm" ? 4 * spec.nchannels * pixels
                                                 : spec.image_bytes(true);
    const std::uintmax_t limit = bytes * (format == "hdr" ? 64 : format == "pnm" ? 1 : best_ratio);
    if (raw > limit)
        source.fail("the header declares " + size + " pixels, but the file of " + std::to_string(bytes) +
                    " bytes cannot hold them");
}

// Tiles are decoded a row of them at a time, and whole even where they reach beyond the image.
void check_tiles(const Source& source, const OIIO::ImageSpec& spec) {
    if (spec.tile_width == 0) return;
    const std::string size = std::to_string(spec.tile_width) + " x " + std::to_string(spec.tile_height);
    if (spec.tile_width < 0 || spec.tile_height <= 0 || spec.tile_depth < 0 || spec.tile_depth > 1)
        source.fail("the tiles are " + size + " x " + std::to_string(spec.tile_depth) +
                    " pixels; allowed are flat ones of 1 to 2147483647 pixels each way");
    const std::uintmax_t pixels = std::uintmax_t(std::max(spec.width, spec.tile_width)) * spec.tile_height;
    if (pixels > most_bytes_of_tiles / (sizeof(float) * spec.nchannels))
        source.fail("the tiles are " + size + " pixels of " + std::to_string(spec.nchannels) +
                    " channels; allowed are " + std::to_string(most_bytes_of_tiles >> 20) +
                    " MiB of floats in a row of tiles");
}

void check_placement(const Source& source, const OIIO::ImageSpec& spec) {
    const int orientation = spec.get_int_attribute("Orientation", 1);
    if (orientation != 1)
        source.fail("the image's orientation is " + std::to_string(orientation) +
                    "; allowed is 1 (first row on top, first column left)");
    if (spec.x != spec.full_x || spec.y != spec.full_y || spec.width != spec.full_width ||
        spec.height != spec.full_height)
        source.fail("the data window (" + std::to_string(spec.width) + " x " + std::to_string(spec.height) + " at " +
                    std::to_string(spec.x) + ", " + std::to_string(spec.y) +
                    ") is not the display window; allowed is an image that fills it");
}

// The channels of red, green and blue.
std::array<int, 3> choose_channels(const OIIO::ImageSpec& spec, ImageFile& image) {
    const auto is = [](std::string name, char letter) {
        name = name.substr(name.rfind('.') == std::string::npos ? 0 : name.rfind('.') + 1);
        return name.size() == 1 && std::toupper(static_cast<unsigned char>(name[0])) == letter;
    };
    std::array<int, 3> chosen{-1, -1, -1};
    for (int c = spec.nchannels - 1; c >= 0; --c)
        for (int k = 0; k < 3; ++k)
            if (is(spec.channelnames[c], "RGB"[k])) chosen[k] = c;
    const bool named = chosen[0] >= 0 && chosen[1] >= 0 && chosen[2] >= 0;
    const int used = spec.nchannels < 3 ? 1 : 3;
    if (!named) chosen = used == 1 ? std::array<int, 3>{0, 0, 0} : std::array<int, 3>{0, 1, 2};
    if (!named && used == 3) image.warnings.push_back("no channels are named R, G and B: the first three were taken");
    if (used == 1) image.warnings.push_back("the image has no colour: it was taken as grey");
    if (spec.nchannels > used)
        image.warnings.push_back("the image has " + std::to_string(spec.nchannels) +
                                 " channels: alpha and further ones were dropped");
    return chosen;
}

std::string name_primaries(const OIIO::ImageSpec& spec) {
    std::array<float, 8> xy{};
    const OIIO::ParamValue* found = spec.find_attribute("chromaticities");
    if (!found || found->type().basesize() * found->type().numelements() * found->type().aggregate != sizeof xy)
        return "unspecified";
    std::copy_n(static_cast<const float*>(found->data()), 8, xy.begin());
    struct Known {
        const char* name;
        std::array<float, 8> xy;
    };
    constexpr Known known[] = {
        {"Rec.709", {.64f, .33f, .30f, .60f, .15f, .06f, .3127f, .3290f}},
        {"Rec.2020", {.708f, .292f, .170f, .797f, .131f, .046f, .3127f, .3290f}},
        {"Display P3", {.68f, .32f, .265f, .69f, .15f, .06f, .3127f, .3290f}},
        {"ACES AP0", {.7347f, .2653f, 0.f, 1.f, .0001f, -.077f, .32168f, .33767f}},
        {"ACEScg AP1", {.713f, .293f, .165f, .83f, .128f, .044f, .32168f, .33767f}},
    };
    for (const Known& k : known) {
        bool same = true;
        for (int i = 0; i < 8; ++i) same &= std::abs(k.xy[i] - xy[i]) < 2e-3f;
        if (same) return k.name;
    }
    std::ostringstream text;
    text << "custom: red " << xy[0] << ' ' << xy[1] << ", green " << xy[2] << ' ' << xy[3] << ", blue " << xy[4] << ' '
         << xy[5] << ", white " << xy[6] << ' ' << xy[7];
    return text.str();
}

void add_notes(const OIIO::ImageSpec& spec, OIIO::ImageInput& input, ImageFile& image) {
    const float exposure = spec.get_float_attribute("hdr:exposure", 1.0f);
    if (exposure != 1)
        image.warnings.push_back("the header says EXPOSURE=" + std::to_string(exposure) +
                                 ": pixels are taken as they are, not divided by it");
    if (spec.get_string_attribute("textureformat") == "LatLong Environment")
        image.warnings.push_back(
            "the EXR envmap attribute says lat-long: OpenEXR's convention would be latlong = openexr");
    if (input.seek_subimage(1, 0)) image.warnings.push_back("the file has several images: the first was taken");
    (void)input.geterror();  // a missing second image is no error
    if (!input.seek_subimage(0, 0)) throw Error(ErrorKind::bad_input, "the first image cannot be read again");
}

bool read_rows(const Source& source, const OIIO::ImageSpec& spec, int begin, int end, std::vector<float>& rows) {
    if (spec.tile_width > 0)
        return source.input->read_tiles(0, 0, spec.x, spec.x + spec.width, spec.y + begin, spec.y + end, 0, 1, 0,
                                        spec.nchannels, OIIO::TypeDesc::FLOAT, rows.data());
    return source.input->read_scanlines(0, 0, spec.y + begin, spec.y + end, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT,
                                        rows.data());
}

// Pixels are written piece by piece: a declared size without data reserves addresses, but no memory.
void read_pixels(const Source& source, const OIIO::ImageSpec& spec, Progress& progress, ImageFile& image) {
    const std::array<int, 3> channels = choose_channels(spec, image);
    const int unit = spec.tile_height > 0 ? spec.tile_height : 16;
    const auto wanted = static_cast<int>(pixels_per_piece / spec.width);
    const int step = std::min(spec.height, std::max(wanted / unit, 1) * unit);
    std::vector<float> rows(std::size_t(step) * spec.width * spec.nchannels);
    image.pixels.reserve(std::size_t(spec.width) * spec.height);
    for (int begin = 0; begin < spec.height; begin += step) {
        progress.check();
        const int end = std::min(spec.height, begin + step);
        // Some readers (TIFF cut short) report success and leave an error behind.
        if (!read_rows(source, spec, begin, end, rows) || source.input->has_error())
            source.fail("rows " + std::to_string(begin) + " to " + std::to_string(end - 1) +
                        " cannot be decoded: " + source.input->geterror());
        image.pixels.resize(std::size_t(end) * spec.width);
        Vec3f* pixel = image.pixels.data() + std::size_t(begin) * spec.width;
        const float* value = rows.data();
        for (std::size_t i = 0; i < std::size_t(end - begin) * spec.width; ++i, value += spec.nchannels)
            pixel[i] = {value[channels[0]], value[channels[1]], value[channels[2]]};
        progress.report(double(end) / spec.height);
    }
}

}  // namespace

ImageFile read_image_file(const std::filesystem::path& file, const SizeCheck& check, Progress& progress) try {
    Source source{file, nullptr};
    if (!std::filesystem::is_regular_file(file)) source.fail("there is no such file");
    const std::string format = sniff(source);
    source.input = OIIO::ImageInput::create(format);
    if (!source.input) throw Error(ErrorKind::internal, "OpenImageIO has no reader for " + format);
    OIIO::ImageSpec spec, config;
    config.attribute("oiio:UnassociatedAlpha", 1);  // else PNG's and TIFF's colours would be multiplied by it
    if (!source.input->open(file.string(), spec, config))
        source.fail("not a readable image: " + source.input->geterror());

    check_size(source, spec, format, check);
    check_tiles(source, spec);
    check_placement(source, spec);
    ImageFile image;
    image.width = spec.width;
    image.height = spec.height;
    image.format = format;
    image.integer = !spec.format.is_floating_point();
    image.openexr_cube = spec.get_string_attribute("textureformat") == "CubeFace Environment";
    image.primaries = name_primaries(spec);
    add_notes(spec, *source.input, image);
    read_pixels(source, spec, progress, image);
    return image;
} catch (const std::bad_alloc&) {
    throw Error(ErrorKind::out_of_resources, file.string() + ": not enough memory for the image");
} catch (const std::filesystem::filesystem_error& e) {
    throw Error(ErrorKind::bad_input, file.string() + ": " + e.code().message());
}

}  // namespace hairbake
