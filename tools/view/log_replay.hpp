// A log of frames, played to the loop in virtual time so that it can be looked at like a run.
#pragma once

#include <filesystem>

#include "drivers/files/temporary_folder.hpp"

namespace patella::view {

class LogReplay {
 public:
  /// Runs `patella`, which is looked for beside this program, on the log. Throws std::runtime_error with what
  /// it said where it failed.
  LogReplay(const std::filesystem::path& log, const std::filesystem::path& configuration);

  /// Of the run; goes with this object.
  std::filesystem::path folder() const { return temporary_ / "run"; }

 private:
  files::TemporaryFolder temporary_;
};

}  // namespace patella::view
