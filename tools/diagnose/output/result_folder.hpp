// The folder that a program of the diagnosis writes to.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace patella::diagnose {

/// A folder for results, made if need be, and taken away again if they do not come.
class ResultFolder {
 public:
  /// Throws app::FileError where it cannot be one.
  explicit ResultFolder(const std::filesystem::path& path);
  ~ResultFolder();
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

  /// Writes all files or none that is incomplete.
  void write(const std::vector<std::pair<const char*, std::string>>& files);

 private:
  std::filesystem::path path_;
  std::vector<std::filesystem::path> made_;  ///< innermost first
};

}  // namespace patella::diagnose
