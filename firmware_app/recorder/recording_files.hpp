// What a run is recorded in: frames.log, ticks.csv, events.log, run.mcap, and shared memory for viewers.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/can/can_frame.hpp"
#include "drivers/can/candump_log.hpp"
#include "firmware_app/formats/mcap_run.hpp"
#include "firmware_app/live/live_run.hpp"
#include "firmware_app/recorder/event_lines.hpp"
#include "firmware_app/recorder/recorder_options.hpp"
#include "firmware_app/recorder/recording_folder.hpp"
#include "firmware_app/recorder/tick_record.hpp"

namespace patella::app {

class RecordingFiles {
 public:
  /// Adds what it creates to `created`, one by one: a file that another run put there meanwhile is not ours.
  /// Throws std::runtime_error as OutputFile does.
  RecordingFiles(const RecorderOptions& options, std::vector<std::filesystem::path>& created);

  void write(const can::Frame& frame);
  void write(const TickRecord& record);
  void flush();
  /// Ends run.mcap with the summary of the run.
  void finish(const formats::McapMetadata& summary);

  /// The first failure of any of them; empty while all is well.
  std::string error() const;

 private:
  template <typename Write>
  void intoMcap(Write&& write);
  formats::MessageTime timeOf(const TickRecord& record);

  std::vector<RecordedBus> buses_;
  std::vector<TickColumn> columns_;
  OutputFile frames_;
  OutputFile ticks_;
  OutputFile events_;
  std::unique_ptr<OutputFile> mcap_file_;
  std::unique_ptr<formats::McapRun> mcap_;
  std::string mcap_error_;
  std::unique_ptr<live::LiveRun> live_;
  EventLines event_lines_;
  std::optional<std::int64_t> loop_epoch_ns_;
  std::string line_;
  std::vector<double> row_;
  std::array<char, can::kMaxLogLine> buffer_{};
};

}  // namespace patella::app
