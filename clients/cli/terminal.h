// What standard error is able to show.
#pragma once

#include <optional>

namespace hairbake {

/// Standard error is a terminal.
bool is_terminal();

/// It is a terminal that understands escape codes: TERM is neither missing, nor empty, nor "dumb".
bool understands_codes();

/// NO_COLOR is set and not empty (no-color.org), or the terminal understands no escape codes.
bool without_colors();

/// Characters in a line: COLUMNS where that is a number from 1 to 10000, else the terminal's own number, else 80.
int columns();

}  // namespace hairbake
