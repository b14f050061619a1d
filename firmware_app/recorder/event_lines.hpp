// The lines of events.log: what changed from one tick to the next.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware_app/recorder/recorder_options.hpp"
#include "firmware_app/recorder/tick_record.hpp"

namespace patella::app {

class EventLines {
 public:
  /// The buses whose names stand with the causes that are about them.
  explicit EventLines(const std::vector<RecordedBus>& buses) : buses_(buses) {}

  /// A line, without its line feed, for a change of state, for every cause that appears or goes, for missed
  /// periods and for what CANopen drives say. False, with `line` as it was, where there is none of these.
  bool next(const TickRecord& record, std::string& line);

 private:
  void appendCauses(const TickRecord& record, std::string& line) const;
  void appendWarnings(const TickRecord& record, std::string& line) const;

  std::vector<RecordedBus> buses_;
  std::uint8_t last_state_ = 255;
  std::uint32_t last_faults_ = 0;
  std::uint32_t last_warnings_ = 0;
};

}  // namespace patella::app
