// The table [mechanism] of serial chains: their links one by one, or the name of a URDF that has them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/model/chain_group.hpp"
#include "firmware_app/files/toml_table.hpp"

namespace patella::app {

/// Either `urdf`, `base` and `tip`, see urdf_file.hpp, or a table [[mechanism.link]] for each link. Throws
/// FileError naming file, line, key, value and what was expected, or what is wrong with the URDF.
/// URDFs that were read are put into `files`.
model::SerialChainParameters readChain(const TomlTable& mechanism, std::vector<std::filesystem::path>& files);

/// Several chains on one base: a table [[mechanism.chain]] for each, with what readChain() takes but gravity,
/// which stands in `mechanism` for all.
model::ChainGroupParameters readChainGroup(const TomlTable& mechanism,
                                           std::vector<std::filesystem::path>& files);

/// The error of a chain or a group that cannot be computed with, at the link and the key that `problem`,
/// which is core's, speaks of. `mechanism`: what it was read from.
FileError chainError(const TomlTable& mechanism, const std::string& problem);

/// What follows `kind`, link by link; readChain() gives back the same numbers to the bit.
std::string chainText(const model::SerialChainParameters& chain);
/// Likewise, and readChainGroup().
std::string chainText(const model::ChainGroupParameters& group);

}  // namespace patella::app
