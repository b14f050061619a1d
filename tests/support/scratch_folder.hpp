// A folder for one test case's files, removed with everything in it.
#pragma once

#include <filesystem>
#include <iterator>
#include <set>
#include <string>

#include "drivers/files/temporary_folder.hpp"

namespace patella::test {

class ScratchFolder : public files::TemporaryFolder {
 public:
  std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path()), {}));
  }
};

/// Paths of everything below a folder, from it.
inline std::set<std::string> listing(const std::filesystem::path& folder) {
  std::set<std::string> paths;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    paths.insert(std::filesystem::relative(entry.path(), folder).string());
  }
  return paths;
}

/// Message of the exception that `action` throws, or a note that it threw none.
template <typename Exception, typename Action>
std::string messageOf(Action&& action) {
  try {
    action();
  } catch (const Exception& error) {
    return error.what();
  }
  return "(nothing was thrown)";
}

}  // namespace patella::test
