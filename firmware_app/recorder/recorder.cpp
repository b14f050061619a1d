#include "firmware_app/recorder/recorder.hpp"

#include <chrono>
#include <limits>
#include <memory>
#include <stdexcept>
#include <system_error>

#include <spdlog/spdlog.h>

#include "drivers/signal_stack.hpp"
#include "firmware_app/recorder/recording_files.hpp"
#include "firmware_app/recorder/recording_folder.hpp"

namespace patella::app {
namespace {

constexpr auto kWriterPeriod = std::chrono::milliseconds(10);
constexpr auto kDiskPeriod = std::chrono::seconds(1);

}  // namespace

Recorder::Recorder(const RecorderOptions& options) : options_(options) {
  requireNoRecording(options.folder);
  requireRoom(options);
  try {
    created_ = missingFolders(options.folder);
    std::error_code error;
    std::filesystem::create_directories(options.folder, error);
    if (error) {
      throw std::runtime_error(options.folder.string() + ": cannot be created: " + error.message());
    }
    files_ = std::make_shared<RecordingFiles>(options, created_);
    thread_ = startThread([this, files = files_] { write(*files); });
  } catch (...) {
    discard();
    throw;
  }
}

Recorder::~Recorder() {
  close();
}

void Recorder::close() noexcept {
  stop_.store(true, std::memory_order_release);
  if (thread_.joinable()) {
    thread_.join();
  }
}

void Recorder::finish(const formats::McapMetadata& summary) noexcept {
  files_->finish(summary);
  error_ = files_->error();
}

void Recorder::discard() noexcept {
  close();
  std::error_code ignored;
  for (auto path = created_.rbegin(); path != created_.rend(); ++path) {
    std::filesystem::remove(*path, ignored);
  }
}

bool Recorder::behind() noexcept PATELLA_NONBLOCKING {
  const auto crowded = [](const auto& ring) { return 4 * ring.size() > 3 * ring.capacity(); };
  const std::uint64_t dropped = dropped_ticks_ + dropped_frames_;
  const bool lost = dropped != dropped_before_;
  dropped_before_ = dropped;
  // A lossless recorder makes the loop wait: its rings may be full.
  return lost || (!options_.lossless && (crowded(ticks_) || crowded(frames_)));
}

void Recorder::tick(const TickRecord& record) noexcept PATELLA_NONBLOCKING {
  const auto write = [&](Entry& entry) noexcept {
    copyRecord(record, entry.record);
    entry.frames = accepted_frames_;
  };
  while (!ticks_.pushBy(write)) {
    if (!options_.lossless) {
      ++dropped_ticks_;
      return;
    }
  }
}

void Recorder::frame(const can::Frame& frame) noexcept PATELLA_NONBLOCKING {
  while (!frames_.push(frame)) {
    if (!options_.lossless) {
      ++dropped_frames_;
      return;
    }
  }
  ++accepted_frames_;
}

// Writes the frames up to the one of that number, and says whether there were any.
bool Recorder::writeFrames(RecordingFiles& files, std::uint64_t count) {
  can::Frame frame;
  bool worked = false;
  while (writtenFrames() < count && frames_.pop(frame)) {
    files.write(frame);
    written_frames_.fetch_add(1, std::memory_order_release);
    worked = true;
  }
  return worked;
}

void Recorder::write(RecordingFiles& files) {
  constexpr auto kAll = std::numeric_limits<std::uint64_t>::max();
  Entry entry;
  auto next_look = std::chrono::steady_clock::now();
  while (true) {
    if (const auto now = std::chrono::steady_clock::now(); options_.min_free_bytes > 0 && now >= next_look) {
      next_look = now + kDiskPeriod;
      disk_low_.store(freeBytes(options_.folder) < options_.min_free_bytes, std::memory_order_relaxed);
    }
    const bool last_round = stop_.load(std::memory_order_acquire);
    bool worked = false;
    while (ticks_.pop(entry)) {
      // The frames of a tick stand before it, so that a run in virtual time gives the same file again.
      writeFrames(files, entry.frames);
      files.write(entry.record);
      written_ticks_.fetch_add(1, std::memory_order_release);
      worked = true;
    }
    if (last_round || !options_.lossless) {
      worked = writeFrames(files, kAll) || worked;
    }
    if (!failed_.load(std::memory_order_relaxed) && !files.error().empty()) {
      failed_.store(true, std::memory_order_relaxed);
      spdlog::error("recording failed: {}", files.error());  // events.log may be what failed
    }
    if (last_round) {
      break;
    }
    if (!worked || !options_.lossless) {
      files.flush();
      std::this_thread::sleep_for(options_.lossless ? std::chrono::milliseconds(1) : kWriterPeriod);
    }
  }
  files.flush();
  error_ = files.error();
}

}  // namespace patella::app
