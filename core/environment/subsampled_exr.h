// OpenEXR files that store luminance and chroma, the chroma in fewer pixels. OpenImageIO does not read them.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "core/environment/color_primaries.h"

namespace hairbake {

/// Reads Y, RY and BY (RY and BY at every second pixel of every second line) with OpenEXR's own RgbaInputFile, which
/// interpolates the chroma. Values pass through half floats. Not thread-safe.
class SubsampledExr {
public:
    /// A rectangle of pixels; the upper left one has the coordinates x and y.
    struct Window {
        int x = 0, y = 0, width = 0, height = 0;
    };

    /// Reads the header.
    /// Throws std::invalid_argument with the fault, without the file's name, where the file has no such channels.
    explicit SubsampledExr(const std::filesystem::path& file);
    ~SubsampledExr();
    SubsampledExr(SubsampledExr&&) noexcept;
    SubsampledExr& operator=(SubsampledExr&&) noexcept;

    Window data_window() const;
    Window display_window() const;
    std::optional<Chromaticities> chromaticities() const;  ///< that the file states
    bool is_latlong() const;                               ///< by its attribute `envmap`
    bool is_cube() const;

    /// Decodes one row of the data window; `row` counts from 0 and must not go down. Values of one row, RGB.
    /// Throws std::invalid_argument with the fault.
    const std::vector<float>& read_row(int row);

private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

}  // namespace hairbake
