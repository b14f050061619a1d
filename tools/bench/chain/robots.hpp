// The chains of public URDF files on which the mechanism is compared.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace patella::bench {

struct Robot {
  std::string name;
  std::string file;  ///< in the folder of URDF files
  std::string base, tip;
};

/// One for each chain of the files.
const std::vector<Robot>& robots();

/// The file's text, with what is wrong in it put right: a link that is named but not declared, and inertias
/// that no body has. Throws std::runtime_error naming a file that cannot be read.
std::string urdfText(const std::filesystem::path& folder, const Robot& robot);

}  // namespace patella::bench
