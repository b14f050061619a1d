// The folder that a program of the diagnosis writes to.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "firmware_app/files/file_error.hpp"

namespace patella::diagnose {

/// A folder for results, tried out at once and made if need be when they are there.
class ResultFolder {
 public:
  /// Throws app::FileError where it could not be one.
  explicit ResultFolder(const std::filesystem::path& path);
  ~ResultFolder();
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

  /// Writes all files or none that is incomplete. A folder that was made for them does not stay where a file
  /// cannot be written.
  void write(const std::vector<std::pair<const char*, std::string>>& files);

 private:
  void tryOut(const std::filesystem::path& there);
  void removeMade() noexcept;
  app::FileError refusal(const std::string& reason) const;

  std::filesystem::path path_;
  std::vector<std::filesystem::path> missing_;  ///< at first; innermost first
  bool made_ = false;                           ///< the missing ones, for files that are not all there
};

}  // namespace patella::diagnose
