// One chain of a URDF (https://wiki.ros.org/urdf/XML), from a base link to a tip.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/chain/chain_parameters.hpp"
#include "firmware_app/files/file_error.hpp"

namespace patella::app {

/// The links after `base` up to `tip`, each in its joint's frame; branches that leave that way are left out,
/// with their masses. Inertial frames are turned into their links' axes. Limits, damping, friction, meshes
/// and transmissions are not looked at.
///
/// Throws FileError naming the file, the link or joint, its value and what was expected: for a file that is
/// no URDF, names that it does not have (with those that it has), a tip that is not beyond the base, joints
/// on the way that are neither fixed, revolute, continuous nor prismatic or that mimic another, none or more
/// than kMaxJoints of them, and for links that no body could be (model::checked()).
std::vector<model::ChainLink> loadUrdfChain(const std::filesystem::path& path, const std::string& base,
                                            const std::string& tip);
/// `name` stands for the file in messages.
std::vector<model::ChainLink> parseUrdfChain(std::string_view text, const std::string& name,
                                             const std::string& base, const std::string& tip);

}  // namespace patella::app
