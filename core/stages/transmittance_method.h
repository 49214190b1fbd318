// How `transmittance.method: auto` chooses, and how many directions a traced bake takes.
#pragma once

#include <cstddef>
#include <string>

#include "core/visibility/transmittance_settings.h"

namespace hairbake {

/// `auto` traces at most so many points (vertices of the hair and positions of the receiver), and sweeps when there are
/// more. Lashes, brows, a beard or a test groom have fewer: there the mean field errs most, and tracing takes seconds.
inline constexpr std::size_t most_traced_points = 20000;

struct ChosenMethod {
    TransmittanceMethod method;  ///< not automatic
    std::string reason;          ///< for the manifest
};

/// A function of the request and of the counts alone, so the choice is the same on every machine.
ChosenMethod choose_method(TransmittanceMethod asked, std::size_t vertices, std::size_t receiver_positions);

/// Directions that a traced bake takes: `directions` times the largest of 9, 4 and 1 that gives at most 4,096. A traced
/// ray knows only its own line, while a swept one sees the mean over a voxel, so tracing needs more directions for the
/// same error (docs/accuracy.md, section 2). A square number stays square, as the stratified set needs it.
///
/// directions: 1 to 4096
int traced_directions(int directions);

}  // namespace hairbake
