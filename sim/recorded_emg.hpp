// EMG of a recorded person in the place of the generator's, so that a simulated leg obeys real muscles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/types.hpp"
#include "drivers/can/dbc.hpp"

namespace patella::sim {

class RecordedEmg {
 public:
  /// Reads the Emg frames of a log (candump -l); other frames are passed over, corrupt ones too. Throws
  /// can::LogError where the log cannot be read, holds no such frame or goes back in time, and
  /// std::invalid_argument when the database lacks the message.
  RecordedEmg(const std::filesystem::path& log, const can::Database& database);

  /// Newest sample, mV, `elapsed_ns` after the first one; the last is held at the end. Calls must not go back
  /// in time.
  const EmgArray& at(std::int64_t elapsed_ns) noexcept PATELLA_NONBLOCKING;

 private:
  struct Sample {
    std::int64_t elapsed_ns;
    EmgArray signal_mV;
  };
  std::vector<Sample> samples_;
  std::size_t newest_ = 0;
};

}  // namespace patella::sim
