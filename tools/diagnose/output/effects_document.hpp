// The library of effects for people, as Markdown.
#pragma once

#include <string>

namespace patella::diagnose {

/// docs/effects.md: of each effect what it is, its equation, its source, its parameters with their ranges,
/// the variable on which it shows, and the simpler effects in whose place it stands.
std::string effectsDocument();

}  // namespace patella::diagnose
