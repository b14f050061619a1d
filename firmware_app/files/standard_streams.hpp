// Standard input, output and error of a program that must not depend on who holds their other end.
#pragma once

#include <cstdio>
#include <string_view>

namespace patella::app {

/// Opens those of the three that are closed, to nowhere: else the next file, socket or line to be opened
/// would take the number, and receive what is printed. Throws std::system_error.
void openStandardStreams();

/// Writes the text out at once. False when that was not possible (nobody reads, disk full, terminal gone).
bool show(std::FILE* stream, std::string_view text) noexcept;

}  // namespace patella::app
