// Takes records from the loop through lock-free rings and writes them to a run folder on a thread of its own:
// frames.log (candump -l), ticks.csv, events.log and, where asked for, run.mcap.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "core/spsc_ring.hpp"
#include "drivers/can/can_frame.hpp"
#include "firmware_app/formats/mcap_writer.hpp"
#include "firmware_app/recorder/recorder_options.hpp"
#include "firmware_app/recorder/tick_record.hpp"

namespace patella::app {

class RecordingFiles;

class Recorder {
 public:
  /// Creates the folder and its files and starts the writer. Throws std::runtime_error naming the path that
  /// cannot be created, or the recording that the folder holds; nothing is left behind then.
  explicit Recorder(const RecorderOptions& options);
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Loop side; never waits (unless lossless), counts what finds no room.
  void tick(const TickRecord& record) noexcept PATELLA_NONBLOCKING;
  void frame(const can::Frame& frame) noexcept PATELLA_NONBLOCKING;

  /// Writes what is left, closes the files and ends the thread. Called by the destructor too.
  void close() noexcept;

  /// After close(): ends run.mcap with what the run came to. Without it, that file is as readable as that of
  /// a run that was killed.
  void finish(const formats::McapMetadata& summary) noexcept;

  /// For a run that is refused before its first tick: closes, and removes what the constructor created.
  void discard() noexcept;

  /// Loop side: records were dropped since the last call, or the rings are three quarters full.
  bool behind() noexcept PATELLA_NONBLOCKING;
  /// Less than min_free_bytes are left; looked at by the writer every second.
  bool diskLow() const noexcept PATELLA_NONBLOCKING { return disk_low_.load(std::memory_order_relaxed); }

  /// Loop side: a file could not be written; from then on nothing more is written to it.
  bool failed() const noexcept PATELLA_NONBLOCKING { return failed_.load(std::memory_order_relaxed); }

  std::uint64_t droppedTicks() const noexcept { return dropped_ticks_; }
  std::uint64_t droppedFrames() const noexcept { return dropped_frames_; }
  std::uint64_t writtenTicks() const noexcept { return written_ticks_.load(std::memory_order_acquire); }
  std::uint64_t writtenFrames() const noexcept { return written_frames_.load(std::memory_order_acquire); }
  /// Empty while all is well; else what failed, e.g. "frames.log: No space left on device". Valid after
  /// close().
  const std::string& error() const noexcept { return error_; }

 private:
  struct Entry {
    std::uint64_t frames = 0;  ///< accepted so far, those of this tick included
    TickRecord record;
  };
  void write(RecordingFiles& files);
  bool writeFrames(RecordingFiles& files, std::uint64_t count);

  // Two seconds of a 1 kHz loop with eight frames a tick.
  SpscRing<Entry> ticks_{2048};
  SpscRing<can::Frame> frames_{16384};
  std::uint64_t dropped_ticks_ = 0;
  std::uint64_t dropped_frames_ = 0;
  std::uint64_t accepted_frames_ = 0;
  std::atomic<std::uint64_t> written_ticks_{0};
  std::atomic<std::uint64_t> written_frames_{0};
  std::atomic<bool> stop_{false};
  std::atomic<bool> disk_low_{false};
  std::atomic<bool> failed_{false};
  std::uint64_t dropped_before_ = 0;
  std::string error_;
  RecorderOptions options_;
  std::vector<std::filesystem::path> created_;  ///< folders from the outermost, then files
  std::shared_ptr<RecordingFiles> files_;
  std::thread thread_;
};

}  // namespace patella::app
