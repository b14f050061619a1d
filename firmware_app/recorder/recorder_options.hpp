// Options of a recorder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/types.hpp"
#include "firmware_app/formats/mcap_run.hpp"

namespace patella::app {

struct RecordedBus {
  std::string interface = "can0";  ///< as frames.log has it
  std::string name{};              ///< as events.log has it; empty: it is the only one
};

struct RecorderOptions {
  std::filesystem::path folder;
  std::vector<RecordedBus> buses = {RecordedBus{}};  ///< by the numbers that frames have
  int joints = kMaxJoints;
  std::string heading;               ///< whole lines, to begin events.log with
  std::uint64_t min_free_bytes = 0;  ///< on the folder's disk, at the start and then as a warning
  bool lossless = false;  ///< wait for the writer instead of dropping: only where no wall clock runs
  /// What run.mcap holds beside the recording; without it, there is no such file.
  std::optional<formats::RunInputs> mcap{};
  /// The newest messages in shared memory, for viewers; left out with a warning where it cannot be.
  bool live = false;
};

}  // namespace patella::app
