// `patella bounds`: the reference of every key of every file.
#pragma once

#include <string>

namespace patella::app {

/// docs/configuration.md: the tables of core/bounds with meanings and defaults, and the effects' parameters,
/// as Markdown.
std::string boundsDocument();

}  // namespace patella::app
