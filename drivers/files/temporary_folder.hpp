// A folder of its own for files that nobody keeps.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>

#include "drivers/files/interruption.hpp"

namespace patella::files {

/// Removed with everything in it when the object goes, or the program is interrupted.
class TemporaryFolder {
 public:
  /// Where the system keeps what is temporary. Throws std::runtime_error naming what cannot be created.
  TemporaryFolder() {
    unkept_.create([this] {
      std::string name = (std::filesystem::temp_directory_path() / "patella-XXXXXX").string();
      if (mkdtemp(name.data()) == nullptr) {
        throw std::runtime_error(name + ": cannot be created");
      }
      return path_ = name;
    });
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const noexcept { return path_; }

 private:
  UnkeptPath unkept_;
  std::filesystem::path path_;
};

}  // namespace patella::files
