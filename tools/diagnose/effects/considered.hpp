// The effects that a diagnosis looks for.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

/// The kinds that were asked for; all of the library where none was. Throws std::invalid_argument, naming it,
/// where one does not exist.
std::vector<std::string> consideredKinds(const std::vector<std::string>& asked);

/// Kinds that are commonly missing: they are told of first, and planned for where nothing else is asked.
std::vector<std::string> commonKinds();

/// EMG channels, from 1, that every recording has.
std::vector<int> recordedChannels(std::span<const Recording> recordings);

}  // namespace patella::diagnose
