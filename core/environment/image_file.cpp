#include "core/environment/image_file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <memory>
#include <new>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include "core/environment/image_header.h"
#include "core/environment/image_kinds.h"
#include "core/environment/image_layers.h"
#include "core/environment/subsampled_exr.h"

namespace hairbake {
namespace {

constexpr int most_channels = 1024, most_parts = 256;
constexpr std::int64_t most_values_in_a_row = 1 << 20;  // channels times width: a reader decodes many rows at once
constexpr std::int64_t pixels_per_piece = 1 << 20;
constexpr int least_coverage = 8;  // a data window covers at least this part of the display window
constexpr std::uintmax_t most_bytes_of_tiles = std::uintmax_t(512) << 20;  // in one row of them, decoded
// The most decoded bytes that one byte of a PNG, TIFF or EXR can represent, for any picture. Deflate reaches 1032:1 (a
// match of 258 bytes in 2 bits). Before deflate, EXR's DWA keeps 2 + 2 bytes of an 8 x 8 block of floats (256 bytes),
// and 2 bytes of a run of 128: together 64 * 1032:1. PNG's 1-bit palettes are decoded to 4 bytes: 32 * 1032:1, TIFF's
// to 3. EXR's PXR24 reaches 4/3 * 1032:1, PIZ 410:1, RLE 64:1, B44A 32:3. TIFF's Zstandard reaches 32768:1 (128 KiB in
// 4 bytes), LZMA 7100:1, LZW 1700:1 (each code one byte longer than the last), PackBits 64:1. Only TIFF's fax, JBIG,
// WebP and LERC of one colour can exceed the limit. Measured on constant maps of 16384 x 8192: at most 33,200:1 (EXR,
// DWAB).
constexpr std::uintmax_t best_ratio = 64 * 1032;

/// A file that begins with another header than on disk.
class FileBehindHeader : public OIIO::Filesystem::IOProxy {
public:
    FileBehindHeader(const std::string& file, ImageHeader header)
        : IOProxy(file, Read), header_(std::move(header)), file_(file, Read) {}
    const ImageHeader& header() const { return header_; }

    const char* proxytype() const override { return "hairbake"; }
    std::size_t size() const override { return header_.text.size() + file_.size() - header_.data_begin; }
    std::size_t read(void* buffer, std::size_t bytes) override {
        const std::size_t count = pread(buffer, bytes, m_pos);
        m_pos += static_cast<std::int64_t>(count);
        return count;
    }
    std::size_t pread(void* buffer, std::size_t bytes, std::int64_t offset) override {
        const auto begin = static_cast<std::size_t>(std::max<std::int64_t>(offset, 0));
        const std::size_t of_header = begin < header_.text.size() ? std::min(bytes, header_.text.size() - begin) : 0;
        if (of_header > 0) std::memcpy(buffer, header_.text.data() + begin, of_header);
        if (of_header == bytes) return bytes;
        const std::size_t place = begin + of_header - header_.text.size() + header_.data_begin;
        return of_header +
               file_.pread(static_cast<char*>(buffer) + of_header, bytes - of_header, static_cast<std::int64_t>(place));
    }

private:
    ImageHeader header_;
    OIIO::Filesystem::IOFile file_;
};

struct Source {
    std::filesystem::path file;
    std::string format;
    std::unique_ptr<FileBehindHeader> behind;  // outlives the input
    std::unique_ptr<OIIO::ImageInput> input;
    std::optional<SubsampledExr> subsampled;  // read instead of the input
    int part = 0;

    AxisOrder order() const { return behind ? behind->header().order : AxisOrder{}; }
    /// `system_error`: as in Error.
    [[noreturn]] void fail(const std::string& what, int system_error = 0) const {
        throw Error(ErrorKind::bad_input, file.string() + ": " + what, {}, system_error);
    }
};

std::string first_bytes(const Source& source) {
    std::ifstream stream(source.file, std::ios::binary);
    if (!stream) source.fail("cannot be opened: " + std::generic_category().message(errno), errno);
    std::string bytes(image_start_bytes, '\0');
    errno = 0;
    stream.read(bytes.data(), image_start_bytes);
    if (stream.bad()) source.fail("cannot be read", errno != 0 ? errno : EIO);
    bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
    return bytes;
}

// The format by the file's first bytes. No other decoder of OpenImageIO ever reads a user's file.
void recognise(Source& source) {
    const std::string start = first_bytes(source);
    const ImageKind kind = kind_of_image(start);
    if (kind.reader.empty())
        source.fail("this is " + std::string(kind.refusal) + "; allowed are HDR, EXR, TIFF, PFM and PNG");
    source.format = kind.reader;
    std::optional<ImageHeader> header;
    if (source.format == "hdr") header = read_radiance_header(start, std::filesystem::file_size(source.file));
    if (source.format == "pnm") header = read_pfm_header(start);
    if (header) source.behind = std::make_unique<FileBehindHeader>(source.file.string(), *std::move(header));
}

// The header in the form in which OpenImageIO would give it.
OIIO::ImageSpec spec_of(const SubsampledExr& file) {
    const SubsampledExr::Window data = file.data_window(), display = file.display_window();
    OIIO::ImageSpec spec(data.width, data.height, 3, OIIO::TypeDesc::HALF);
    spec.x = data.x;
    spec.y = data.y;
    spec.full_x = display.x;
    spec.full_y = display.y;
    spec.full_width = display.width;
    spec.full_height = display.height;
    if (const auto xy = file.chromaticities())
        spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), xy->data());
    if (file.is_cube()) spec.attribute("textureformat", "CubeFace Environment");
    if (file.is_latlong()) spec.attribute("textureformat", "LatLong Environment");
    return spec;
}

void open(Source& source, OIIO::ImageSpec& spec) {
    source.input = OIIO::ImageInput::create(source.format);
    if (!source.input) throw Error(ErrorKind::internal, "OpenImageIO has no reader for " + source.format);
    OIIO::ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1);  // else PNG's and TIFF's colours would be multiplied by it
    if (source.behind) source.input->set_ioproxy(source.behind.get());
    if (source.input->open(source.file.string(), spec, config)) return;
    const std::string reason = source.input->geterror();
    if (reason.find("Subsampled") != std::string::npos) {
        source.subsampled.emplace(source.file);
        spec = spec_of(*source.subsampled);
        return;
    }
    source.fail("not a readable image: " + reason);
}

/// Size of the picture: the display window, or the scan lines in the usual axis order.
struct PictureSize {
    int width = 0, height = 0;
};

PictureSize size_of(const Source& source, const OIIO::ImageSpec& spec) {
    if (source.order().columns) return {spec.height, spec.width};
    return {spec.full_width, spec.full_height};
}

std::string size_text(int width, int height) { return std::to_string(width) + " x " + std::to_string(height); }

void check_size(const Source& source, const OIIO::ImageSpec& spec, const SizeCheck& check) {
    const PictureSize size = size_of(source, spec);
    const std::string wrong = check(size.width, size.height);
    if (!wrong.empty()) source.fail(wrong);
    if (spec.nchannels < 1 || spec.nchannels > most_channels ||
        std::int64_t(spec.width) * spec.nchannels > most_values_in_a_row)
        source.fail("the file has " + std::to_string(spec.nchannels) + " channels; allowed are 1 to " +
                    std::to_string(most_channels) + ", and " + std::to_string(most_values_in_a_row) +
                    " values in a row of pixels");
    if (spec.depth > 1 || spec.deep) source.fail("the image is volumetric or deep; allowed is a flat image");
    // A run of HDR's encoding covers at most 127 bytes with 2; PFM is not compressed.
    const std::uintmax_t bytes = std::filesystem::file_size(source.file), pixels = spec.image_pixels();
    const std::uintmax_t raw = source.format == "hdr"   ? 4 * pixels
                               : source.format == "pnm" ? 4 * spec.nchannels * pixels
                                                        : spec.image_bytes(true);
    const std::uintmax_t limit = bytes * (source.format == "hdr" ? 64 : source.format == "pnm" ? 1 : best_ratio);
    if (raw > limit)
        source.fail("the header declares " + size_text(spec.width, spec.height) + " pixels, but the file of " +
                    std::to_string(bytes) + " bytes cannot hold them");
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
    const auto overlap = [](std::int64_t begin, std::int64_t size, std::int64_t full_begin, std::int64_t full_size) {
        return std::max<std::int64_t>(0, std::min(begin + size, full_begin + full_size) - std::max(begin, full_begin));
    };
    const std::int64_t covered = overlap(spec.x, spec.width, spec.full_x, spec.full_width) *
                                 overlap(spec.y, spec.height, spec.full_y, spec.full_height);
    const std::int64_t data = std::int64_t(spec.width) * spec.height,
                       display = std::int64_t(spec.full_width) * spec.full_height;
    if (covered < display / least_coverage || covered < data / least_coverage || covered == 0)
        source.fail("the data window (" + size_text(spec.width, spec.height) + " at " + std::to_string(spec.x) + ", " +
                    std::to_string(spec.y) + ") and the display window (" +
                    size_text(spec.full_width, spec.full_height) + " at " + std::to_string(spec.full_x) + ", " +
                    std::to_string(spec.full_y) +
                    ") share less than an eighth of one of them; allowed is an image that "
                    "fills its display window, or most of it");
}

// All parts of an EXR file; the first image of other files, whose further ones are pages or smaller copies.
std::vector<ImagePart> parts_of(const Source& source, ImageFile& image) {
    std::vector<ImagePart> parts;
    while (static_cast<int>(parts.size()) < most_parts &&
           source.input->seek_subimage(static_cast<int>(parts.size()), 0)) {
        if (source.format != "openexr" && !parts.empty()) {
            image.warnings.push_back("the file has several images: the first was taken");
            break;
        }
        const OIIO::ImageSpec spec = source.input->spec();
        parts.push_back({std::string(spec.get_string_attribute("oiio:subimagename")), spec.channelnames});
    }
    (void)source.input->geterror();  // the end of the parts is no error
    return parts;
}

std::optional<Chromaticities> chromaticities_of(const Source& source, const OIIO::ImageSpec& spec) {
    if (source.behind) return source.behind->header().primaries;
    Chromaticities xy{};
    const OIIO::ParamValue* found = spec.find_attribute("chromaticities");
    if (!found || found->type().basesize() * found->type().numelements() * found->type().aggregate != sizeof xy)
        return std::nullopt;
    std::copy_n(static_cast<const float*>(found->data()), xy.size(), xy.begin());
    return xy;
}

void take_facts(const Source& source, const OIIO::ImageSpec& spec, ImageFile& image) {
    image.format = source.format;
    image.integer = !spec.format.is_floating_point();
    const std::string_view texture = spec.get_string_attribute("textureformat");
    if (source.format == "openexr" && texture == "CubeFace Environment") image.envmap = OpenExrEnvironment::cube;
    if (source.format == "openexr" && texture == "LatLong Environment") image.envmap = OpenExrEnvironment::latlong;
    image.chromaticities = chromaticities_of(source, spec);
    if (image.chromaticities)
        if (const std::string fault = fault_of(*image.chromaticities); !fault.empty()) {
            image.warnings.push_back("the file's primaries were not used: " + fault);
            image.chromaticities.reset();
        }
    const bool whole = spec.x == spec.full_x && spec.y == spec.full_y && spec.width == spec.full_width &&
                       spec.height == spec.full_height;
    if (!whole)
        image.warnings.push_back("the data window (" + size_text(spec.width, spec.height) +
                                 ") is not the display window (" + size_text(spec.full_width, spec.full_height) +
                                 "): pixels outside the data window are black, those beyond the display window are not "
                                 "used");
}

// Channels begin .. end of rows of the chosen part, [end_row - begin_row][width][end - begin].
struct ChannelRange {
    int begin = 0, end = 0;
    int count() const { return end - begin; }
};

bool read_rows(Source& source, const OIIO::ImageSpec& spec, ChannelRange channels, int begin, int end,
               std::vector<float>& rows) {
    if (source.subsampled) {
        for (int row = begin; row < end; ++row) {
            const std::vector<float>& values = source.subsampled->read_row(row);
            std::copy(values.begin(), values.end(),
                      rows.begin() + static_cast<std::ptrdiff_t>(row - begin) * 3 * spec.width);
        }
        return true;
    }
    if (spec.tile_width > 0)
        return source.input->read_tiles(source.part, 0, spec.x, spec.x + spec.width, spec.y + begin, spec.y + end, 0, 1,
                                        channels.begin, channels.end, OIIO::TypeDesc::FLOAT, rows.data());
    return source.input->read_scanlines(source.part, 0, spec.y + begin, spec.y + end, 0, channels.begin, channels.end,
                                        OIIO::TypeDesc::FLOAT, rows.data());
}

// Copies the part of one decoded row that lies in the display window.
void place_row(const OIIO::ImageSpec& spec, const std::array<int, 3>& channels, int stride, const float* values,
               Vec3f* row) {
    const int begin = std::max(spec.x, spec.full_x), end = std::min(spec.x + spec.width, spec.full_x + spec.full_width);
    for (int x = begin; x < end; ++x) {
        const float* value = values + static_cast<std::ptrdiff_t>(x - spec.x) * stride;
        row[x - spec.full_x] = {value[channels[0]], value[channels[1]], value[channels[2]]};
    }
}

// Pixels are written piece by piece: a declared size without data reserves addresses, but no memory.
void read_pixels(Source& source, const OIIO::ImageSpec& spec, std::array<int, 3> channels, Progress& progress,
                 ImageFile& image) {
    const auto [lowest, highest] = std::minmax_element(channels.begin(), channels.end());
    const ChannelRange range{*lowest, *highest + 1};
    for (int& c : channels) c -= range.begin;
    const int unit = spec.tile_height > 0 ? spec.tile_height : 16;
    const auto wanted = static_cast<int>(pixels_per_piece / spec.width);
    const int step = std::min(spec.height, std::max(wanted / unit, 1) * unit);
    const auto width = static_cast<std::size_t>(spec.full_width), height = static_cast<std::size_t>(spec.full_height);
    std::vector<float> rows(std::size_t(step) * spec.width * range.count());
    image.pixels.reserve(width * height);
    for (int begin = 0; begin < spec.height; begin += step) {
        progress.check();
        const int end = std::min(spec.height, begin + step);
        // Some readers (TIFF cut short) report success and leave an error behind.
        if (!read_rows(source, spec, range, begin, end, rows) || (!source.subsampled && source.input->has_error()))
            source.fail("rows " + std::to_string(begin) + " to " + std::to_string(end - 1) +
                        " cannot be decoded: " + source.input->geterror());
        for (int row = begin; row < end; ++row) {
            const std::int64_t y = std::int64_t(spec.y) + row - spec.full_y;
            if (y < 0 || y >= spec.full_height) continue;
            image.pixels.resize(static_cast<std::size_t>(y + 1) * width);
            place_row(spec, channels, range.count(),
                      rows.data() + static_cast<std::size_t>(row - begin) * spec.width * range.count(),
                      image.pixels.data() + static_cast<std::size_t>(y) * width);
        }
        progress.report(double(end) / spec.height);
    }
    image.pixels.resize(width * height);
}

/// An image whose header was read and checked.
struct OpenedImage {
    Source source;
    OIIO::ImageSpec spec;
    std::array<int, 3> channels{};
    bool luminance_chroma = false;  ///< the channels are Y, RY and BY
    ImageFile image;                ///< without pixels
};

/// Which channels are read, in which part of the file.
void choose_channels(OpenedImage& opened) {
    Source& source = opened.source;
    if (source.subsampled) {
        opened.channels = {0, 1, 2};
        return;
    }
    const ChosenLayer layer = choose_layer(parts_of(source, opened.image), source.format == "openexr");
    source.part = layer.part;
    opened.channels = layer.channels;
    opened.luminance_chroma = layer.luminance_chroma;
    opened.image.warnings.insert(opened.image.warnings.end(), layer.warnings.begin(), layer.warnings.end());
    if (!source.input->seek_subimage(layer.part, 0))
        source.fail("part " + std::to_string(layer.part) + " cannot be read");
    opened.spec = source.input->spec();
}

/// Y, RY and BY of full size to RGB: R = (RY + 1) Y, B = (BY + 1) Y, and G so that the luminance is Y (OpenEXR's
/// technical introduction, "Luminance/Chroma Images").
void take_luminance_chroma(const ImageFile& image, std::vector<Vec3f>& pixels) {
    const Vec3d weights = luminance_weights(image.chromaticities.value_or(default_chromaticities()));
    for (Vec3f& p : pixels) {
        const double y = p.x, red = (double{p.y} + 1) * y, blue = (double{p.z} + 1) * y;
        p = Vec3f(Vec3d(red, (y - weights.x * red - weights.z * blue) / weights.y, blue));
    }
}

OpenedImage open_image(const std::filesystem::path& file, const SizeCheck& check) {
    OpenedImage opened;
    Source& source = opened.source;
    OIIO::ImageSpec& spec = opened.spec;
    ImageFile& image = opened.image;
    source.file = file;
    if (!std::filesystem::is_regular_file(file)) {
        const bool is_there = std::filesystem::exists(file);
        source.fail(is_there ? "this is not a regular file" : "there is no such file", is_there ? 0 : ENOENT);
    }
    recognise(source);
    open(source, spec);
    choose_channels(opened);
    check_size(source, spec, check);
    check_tiles(source, spec);
    check_placement(source, spec);
    image.width = size_of(source, spec).width;
    image.height = size_of(source, spec).height;
    take_facts(source, spec, image);
    return opened;
}

/// Runs `body`, whose other exceptions become errors about the file.
template <class Body>
ImageFile naming_image(const std::filesystem::path& file, const Body& body) try {
    return body();
} catch (const std::invalid_argument& e) {
    throw Error(ErrorKind::bad_input, file.string() + ": " + e.what());
} catch (const std::bad_alloc&) {
    throw Error(ErrorKind::out_of_resources, file.string() + ": not enough memory for the image");
} catch (const std::filesystem::filesystem_error& e) {
    throw Error(ErrorKind::bad_input, file.string() + ": " + e.code().message(), {}, e.code().value());
}

}  // namespace

ImageFile read_image_file(const std::filesystem::path& file, const SizeCheck& check, Progress& progress) {
    return naming_image(file, [&] {
        OpenedImage opened = open_image(file, check);
        ImageFile image = std::move(opened.image);
        read_pixels(opened.source, opened.spec, opened.channels, progress, image);
        if (opened.luminance_chroma) take_luminance_chroma(image, image.pixels);
        if (opened.source.behind) {
            const ImageHeader& header = opened.source.behind->header();
            put_in_order(header.order, image.width, image.height, image.pixels);
            for (std::string warning : {take_off_exposure(header, image.pixels), take_xyz(header, image.pixels)})
                if (!warning.empty()) image.warnings.push_back(std::move(warning));
        }
        return image;
    });
}

ImageFile read_image_facts(const std::filesystem::path& file, const SizeCheck& check) {
    return naming_image(file, [&] { return open_image(file, check).image; });
}

}  // namespace hairbake
