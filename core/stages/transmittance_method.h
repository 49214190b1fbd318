// How `transmittance.method: auto` chooses, and how many directions a traced bake takes.
#pragma once

#include <cstddef>
#include <string>

#include "core/visibility/transmittance_settings.h"

namespace hairbake {

/// `auto` traces at most so many points (vertices of the hair and positions of the receiver), and sweeps when there are
/// more: 0.02 times the cube of `directions`, at least 5,000 and at most 250,000. That is 5,000 for the preset draft,
/// 20,000 by default (a beard, brows, a test groom: some 10 seconds on two cores) and 250,000 for the preset final (most
/// grooms of games: some minutes). The more directions are asked for, the less the mean field's own error is wanted and
/// the more time is granted.
///
/// directions: as the request says, 1 to 4096
std::size_t most_traced_points(int directions);

struct ChosenMethod {
    TransmittanceMethod method;  ///< not automatic
    std::string reason;          ///< for the manifest
};

/// A function of the request and of the counts alone, so the choice is the same on every machine.
ChosenMethod choose_method(const TransmittanceSettings& settings, std::size_t vertices, std::size_t receiver_positions);

/// Directions that a traced bake takes: `directions` times the largest of 9, 4 and 1 that gives at most 4,096. A traced
/// ray knows only its own line, while a swept one sees the mean over a voxel, so tracing needs more directions for the
/// same error (docs/accuracy.md, section 2). A square number stays square, as the stratified set needs it.
///
/// directions: 1 to 4096
int traced_directions(int directions);

}  // namespace hairbake
