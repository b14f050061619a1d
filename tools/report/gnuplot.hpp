// Draws figures with gnuplot, fed through a pipe.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "tools/report/figure.hpp"

namespace patella::report {

/// One SVG document a figure, ready to stand inside a page. Throws std::runtime_error when gnuplot is
/// missing or fails.
std::vector<std::string> drawSvg(std::span<const Figure> figures);

/// All figures in one picture, two a row. Throws as above, and app::FileError when the picture cannot be
/// written; then nothing is left of it.
void drawPng(std::span<const Figure> figures, const std::string& title, const std::filesystem::path& path);

}  // namespace patella::report
