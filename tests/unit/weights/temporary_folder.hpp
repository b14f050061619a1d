// A folder that lasts as long as a test case.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace patella::app {

class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::filesystem::path file(const std::string& name) const { return path_ / name; }
  /// Names of what is in it, sorted.
  std::vector<std::string> contents() const;

 private:
  std::filesystem::path path_;
};

}  // namespace patella::app
