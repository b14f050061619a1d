// `patella bounds`: what every number of every file may be.
#pragma once

#include <string>

namespace patella::app {

/// docs/configuration_bounds.md: the tables of core/bounds and the ranges of the effects, as Markdown.
std::string boundsDocument();

}  // namespace patella::app
