// Standard output of the command line: a write that fails is an error.
#pragma once

#include <string>
#include <string_view>

namespace hairbake {

/// Writes the text and flushes it. Thread-safe.
/// Throws Error(out_of_resources) when the disk is full, Error(bad_input) for every other failure.
void print_text(std::string_view text);

/// The same with a line end.
void print_line(const std::string& line);

/// Opens /dev/null in place of those standard streams that are closed, so that no file of a result takes their number.
/// What is written to a closed standard output is then an error. Call it at the start of main().
void occupy_closed_streams();

}  // namespace hairbake
