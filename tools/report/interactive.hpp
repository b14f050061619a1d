// Interactive figures of a page: their curves as data, and the script that draws them.
#pragma once

#include <string>
#include <string_view>

#include "tools/report/figure.hpp"

namespace patella::report {

/// The figure's curves, levels and shades as a JSON element of the page, which stands inside its <figure>.
std::string curveElement(const Figure& figure);

/// tools/report/interactive.js as an element, for the end of a page that has such figures; empty for others.
std::string scriptElement(std::string_view page);

}  // namespace patella::report
