#include "core/output/canvas.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

#include <algorithm>

namespace hairbake {

Canvas::Canvas(int width, int height, Color background)
    : width_(width), height_(height), rgb_(static_cast<std::size_t>(width) * height * 3) {
    fill(0, 0, width, height, background);
}

void Canvas::fill(int x, int y, int width, int height, Color color) {
    const int right = std::min(x + width, width_), bottom = std::min(y + height, height_);
    for (int row = std::max(0, y); row < bottom; ++row)
        for (int column = std::max(0, x); column < right; ++column)
            std::copy(color.begin(), color.end(), rgb_.begin() + (static_cast<std::size_t>(row) * width_ + column) * 3);
}

bool Canvas::text(int x, int y, const std::string& words, int size, Color color, Align align, bool bold) {
    using namespace OIIO;
    const std::string font =
        std::string("/usr/share/fonts/truetype/dejavu/DejaVuSans") + (bold ? "-Bold" : "") + ".ttf";
    ImageBuf picture(ImageSpec(width_, height_, 3, TypeDesc::UINT8), rgb_.data());  // draws into rgb_ itself
    const float rgb[] = {color[0] / 255.f, color[1] / 255.f, color[2] / 255.f};
    const auto anchor = align == Align::left     ? ImageBufAlgo::TextAlignX::Left
                        : align == Align::center ? ImageBufAlgo::TextAlignX::Center
                                                 : ImageBufAlgo::TextAlignX::Right;
    const bool drawn = ImageBufAlgo::render_text(picture, x, y, words, size, font, rgb, anchor,
                                                 ImageBufAlgo::TextAlignY::Baseline, 0, ROI(), 1);
    if (!drawn) picture.geterror();  // read it here, or OpenImageIO prints it
    return drawn;
}

}  // namespace hairbake
