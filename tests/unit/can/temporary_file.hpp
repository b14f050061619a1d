// A file that a test writes and that goes with it.
#pragma once

#include <filesystem>
#include <fstream>
#include <string_view>

#include "drivers/files/temporary_folder.hpp"

namespace patella::can::test {

class TemporaryFile {
 public:
  explicit TemporaryFile(std::string_view content) { std::ofstream(path_, std::ios::binary) << content; }
  const std::filesystem::path& path() const { return path_; }

 private:
  files::TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "file";
};

}  // namespace patella::can::test
