#include "core/environment/subsampled_exr.h"

#include <OpenEXR/ImfArray.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <OpenEXR/ImfStandardAttributes.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

namespace hairbake {
namespace {

SubsampledExr::Window window_of(const Imath::Box2i& box) {
    const auto side = [](int low, int high) {
        const std::int64_t size = std::int64_t(high) - low + 1;
        if (size < 1 || size > std::numeric_limits<int>::max()) throw std::invalid_argument("a window has no size");
        return static_cast<int>(size);
    };
    return {box.min.x, box.min.y, side(box.min.x, box.max.x), side(box.min.y, box.max.y)};
}

}  // namespace

struct SubsampledExr::Implementation {
    explicit Implementation(std::string path)
        : name(std::move(path)), header(Imf::MultiPartInputFile(name.c_str(), 0).header(0)) {}

    std::string name;
    Imf::Header header;
    /// Its constructor takes memory for rows as wide as the header says, so it is made when that has been checked.
    std::optional<Imf::RgbaInputFile> file;
    std::vector<Imf::Rgba> pixels;
    std::vector<float> values;
};

SubsampledExr::SubsampledExr(const std::filesystem::path& file) try
    : implementation_(std::make_unique<Implementation>(file.string())) {
    const Imf::ChannelList& channels = implementation_->header.channels();
    const auto chroma = [&](const char* name) {
        const Imf::Channel* channel = channels.findChannel(name);
        return channel && channel->xSampling == 2 && channel->ySampling == 2;
    };
    const bool known = channels.findChannel("Y") && !channels.findChannel("R") && chroma("RY") && chroma("BY");
    if (!known)
        throw std::invalid_argument(
            "it stores channels in fewer pixels than the image has; read are Y with RY and BY at every second pixel of "
            "every second line; write it again as RGB");
} catch (const std::invalid_argument&) {
    throw;
} catch (const std::exception& error) {
    throw std::invalid_argument(std::string("not a readable image: ") + error.what());
}

SubsampledExr::~SubsampledExr() = default;
SubsampledExr::SubsampledExr(SubsampledExr&&) noexcept = default;
SubsampledExr& SubsampledExr::operator=(SubsampledExr&&) noexcept = default;

SubsampledExr::Window SubsampledExr::data_window() const { return window_of(implementation_->header.dataWindow()); }
SubsampledExr::Window SubsampledExr::display_window() const {
    return window_of(implementation_->header.displayWindow());
}

std::optional<Chromaticities> SubsampledExr::chromaticities() const {
    const Imf::Header& header = implementation_->header;
    if (!Imf::hasChromaticities(header)) return {};
    const Imf::Chromaticities& c = Imf::chromaticities(header);
    return Chromaticities{c.red.x, c.red.y, c.green.x, c.green.y, c.blue.x, c.blue.y, c.white.x, c.white.y};
}

bool SubsampledExr::is_latlong() const {
    const Imf::Header& header = implementation_->header;
    return Imf::hasEnvmap(header) && Imf::envmap(header) == Imf::ENVMAP_LATLONG;
}
bool SubsampledExr::is_cube() const {
    const Imf::Header& header = implementation_->header;
    return Imf::hasEnvmap(header) && Imf::envmap(header) == Imf::ENVMAP_CUBE;
}

const std::vector<float>& SubsampledExr::read_row(int row) try {
    const Window window = data_window();
    const auto width = static_cast<std::size_t>(window.width);
    if (!implementation_->file) implementation_->file.emplace(implementation_->name.c_str(), 0);
    implementation_->pixels.resize(width);
    // The frame buffer's address is that of pixel (0, 0): one row serves all, as its stride between rows is 0.
    implementation_->file->setFrameBuffer(implementation_->pixels.data() - window.x, 1, 0);
    implementation_->file->readPixels(window.y + row);
    implementation_->values.resize(3 * width);
    for (std::size_t x = 0; x < width; ++x) {
        const Imf::Rgba& p = implementation_->pixels[x];
        implementation_->values[3 * x] = p.r;
        implementation_->values[3 * x + 1] = p.g;
        implementation_->values[3 * x + 2] = p.b;
    }
    return implementation_->values;
} catch (const std::exception& error) {
    throw std::invalid_argument("row " + std::to_string(row) + " cannot be decoded: " + error.what());
}

}  // namespace hairbake
