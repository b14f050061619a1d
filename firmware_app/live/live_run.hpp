// A run as it goes, for viewers: its messages into shared memory.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_app/formats/run_messages.hpp"
#include "firmware_app/live/live_ring.hpp"

namespace patella::live {

class LiveRun {
 public:
  /// `columns` are those of ticks.csv. Throws as RingWriter does.
  LiveRun(const std::filesystem::path& folder, const std::vector<std::string>& columns);

  void tick(std::span<const double> row, const formats::MessageTime& time) {
    messages_.tick(row, time, sink_);
  }
  void frame(const can::Frame& frame, std::string_view interface, const formats::MessageTime& time) {
    messages_.frame(frame, interface, time, sink_);
  }
  void event(std::string_view line, const formats::MessageTime& time) { messages_.event(line, time, sink_); }

 private:
  formats::RunMessages messages_;
  RingWriter ring_;
  formats::RunMessages::Sink sink_;
};

/// The channels of a run, from the description in its ring. Throws std::runtime_error for text that is none.
std::vector<formats::ChannelDescription> channelsOf(const std::string& description);

}  // namespace patella::live
