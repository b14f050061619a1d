// A recorded run from its beginning to its end: frames, ticks and events in the order in which the recorder
// wrote them.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/can/can_frame.hpp"
#include "firmware_app/formats/run_messages.hpp"

namespace patella::convert {

class RunVisitor {
 public:
  RunVisitor() = default;
  virtual ~RunVisitor() = default;
  RunVisitor(const RunVisitor&) = delete;
  RunVisitor& operator=(const RunVisitor&) = delete;

  /// Before all others: the columns of ticks.csv.
  virtual void begin(const std::vector<std::string>& columns) = 0;
  virtual void frame(const can::Frame& frame, std::string_view interface,
                     const formats::MessageTime& time) = 0;
  virtual void tick(std::span<const double> row, const formats::MessageTime& time) = 0;
  virtual void event(std::string_view line, const formats::MessageTime& time) = 0;
};

/// Walks through the folder of a run. The run's time zero is put at the stamp of its first frame, from which
/// it differs by less than a tick. `progress` is told which fraction of the ticks is done, after each. Throws
/// std::runtime_error naming file and line.
void walkRun(const std::filesystem::path& run, RunVisitor& visitor,
             const std::function<void(double fraction)>& progress);

}  // namespace patella::convert
