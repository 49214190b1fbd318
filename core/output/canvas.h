// A small 8-bit sRGB drawing surface for the preview.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace hairbake {

using Color = std::array<std::uint8_t, 3>;

/// Rows from the top. Drawing beyond the edges is cut off. Not thread-safe.
class Canvas {
public:
    Canvas(int width, int height, Color background);

    int width() const { return width_; }
    int height() const { return height_; }
    const std::vector<std::uint8_t>& rgb() const { return rgb_; }

    void fill(int x, int y, int width, int height, Color color);
    void set(int x, int y, Color color) { fill(x, y, 1, 1, color); }

    enum class Align { left, center, right };

    /// Draws text whose baseline is at y, in DejaVu Sans of `size` pixels. Returns false where the font (Debian's
    /// fonts-dejavu-core) is missing; nothing is drawn then.
    bool text(int x, int y, const std::string& words, int size, Color color, Align align = Align::left,
              bool bold = false);

private:
    int width_, height_;
    std::vector<std::uint8_t> rgb_;
};

}  // namespace hairbake
